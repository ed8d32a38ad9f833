//! What a line asks for, and the answers to it.

use super::splitter::{LONGEST_LINE, Line, command};
use super::{grbl, reprap};
use fivebar_files::job::{
    Action, Dialect, GcodeError, JobOptions, JobStream, Placement, Step, WarningKind,
};
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Settings};
use fivebar_sim::path_queue::{RAPID, Shares, divided};

/// Length of the rest in which the tool's level changes [s].
const LEVEL_CHANGE: f32 = 1e-3;

/// What a line has the machine do.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::bridge) enum Order {
    /// Find the joint angles.
    Home,
    /// Clear a latched fault.
    Unlock,
    /// Switch the bridges off.
    Disarm,
    /// Add these moves to the path. Each of them starts where the one before it ends.
    Moves(Vec<Move>),
    /// The same, for a jog, which may be cancelled.
    Jog(Vec<Move>),
    /// Wait until the arm rests at the end of its path.
    Finish,
    /// The same, and then wait for the user.
    Pause,
    /// Wait until few of the moves that were added wait.
    Accepted,
    /// Wait until homing has ended.
    Homed,
    /// Wait until the user goes on.
    Resumed,
}

/// The answer to a line that is not refused.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::bridge) struct Response {
    /// What is sent at once.
    pub(in crate::bridge) text: String,
    /// What is to be done, in order.
    pub(in crate::bridge) orders: Vec<Order>,
    /// What is sent when all orders are accepted.
    pub(in crate::bridge) ok: String,
}

impl Response {
    pub(super) fn new(text: String, orders: Vec<Order>) -> Self {
        let ok = "ok\n".into();
        Self { text, orders, ok }
    }
}

/// Why a line is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::bridge) struct Refusal {
    /// The number of Grbl's error.
    pub(in crate::bridge) code: u8,
    pub(in crate::bridge) why: String,
}

impl Refusal {
    pub(in crate::bridge) fn new(code: u8, why: impl Into<String>) -> Self {
        let why = why.into();
        Self { code, why }
    }

    /// A move or a jog before homing or while a fault is latched.
    pub(in crate::bridge) fn locked(why: impl Into<String>) -> Self {
        Self::new(9, why)
    }
}

impl From<GcodeError> for Refusal {
    fn from(error: GcodeError) -> Self {
        let code = match error {
            GcodeError::Syntax(_) => 1,
            GcodeError::UnknownGCode(_)
            | GcodeError::ChangesDrawing(..)
            | GcodeError::SecondSystem(..)
            | GcodeError::Subprogram(_)
            | GcodeError::Helix => 20,
            GcodeError::Conflict(..) => 24,
            GcodeError::Repeated(_) => 25,
            GcodeError::NoFeed | GcodeError::Feed => 22,
            GcodeError::Power => 4,
            GcodeError::NoMode | GcodeError::StrayWord(_) => 36,
            GcodeError::ArcForm
            | GcodeError::ArcRadius
            | GcodeError::ArcEnds(..)
            | GcodeError::ArcChord => 33,
            GcodeError::TooFar(_) => 15,
            _ => 2,
        };
        Self::new(code, error.to_string())
    }
}

/// The state of the machine, by the names of Grbl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::bridge) enum MachineState {
    Idle,
    Run,
    /// At rest on the path, or on the way to rest there.
    Hold {
        rests: bool,
    },
    Jog,
    Home,
    /// Not homed, or a fault is latched.
    Alarm,
}

/// What reports show.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::bridge) struct View {
    pub(in crate::bridge) state: MachineState,
    pub(in crate::bridge) homed: bool,
    pub(in crate::bridge) armed: bool,
    /// The tool in the frame of the base [m]; none if it is unknown.
    pub(in crate::bridge) tool: Option<[f64; 2]>,
    /// The tool's speed [m/s].
    pub(in crate::bridge) speed: f64,
    /// The tool's level, 0…1.
    pub(in crate::bridge) level: f64,
    /// The shares of speed and power that the user has chosen.
    pub(in crate::bridge) shares: Shares,
    /// How many moves the controller accepts now.
    pub(in crate::bridge) free: u8,
    /// Bytes of lines that wait.
    pub(in crate::bridge) waiting: usize,
}

/// The protocols of one connection.
pub(in crate::bridge) struct Engine {
    pub(super) stream: JobStream,
    /// The stream before the present line, for the case that the line is refused.
    before: Option<JobStream>,
    /// The machine's zero [m].
    pub(super) home: [f64; 2],
    pub(super) settings: Settings,
    pub(super) full_power: f64,
    /// The number of the last accepted line.
    pub(super) last_line: Option<i64>,
    /// The level that the last move was given.
    level: u16,
}

impl Engine {
    pub(in crate::bridge) fn new(
        placement: &Placement,
        options: JobOptions,
        settings: &Settings,
    ) -> Self {
        Self {
            full_power: options.full_power,
            stream: JobStream::new(placement, options),
            before: None,
            home: placement.home,
            settings: *settings,
            last_line: None,
            level: 0,
        }
    }

    /// What is sent when a sender connects, and after an emergency stop.
    pub(in crate::bridge) fn greeting(dialect: Dialect, locked: bool) -> String {
        match dialect {
            Dialect::Grbl => grbl::greeting(locked),
            Dialect::RepRap => reprap::greeting(),
        }
    }

    /// Sets the tool's position [m] after homing and after a stop that has dropped the path.
    pub(in crate::bridge) fn set_position(&mut self, tool: [f64; 2]) {
        self.before = None;
        self.stream.set_position(tool);
        self.level = 0;
    }

    /// Forgets the number of the last line.
    pub(in crate::bridge) fn forget_numbers(&mut self) {
        self.last_line = None;
    }

    /// What the line asks for.
    ///
    /// # Errors
    /// Why the line is refused; nothing has changed then.
    pub(in crate::bridge) fn line(
        &mut self,
        line: &Line,
        view: &View,
    ) -> Result<Response, Refusal> {
        self.before = None;
        if line.length > LONGEST_LINE {
            return Err(Refusal::new(
                11,
                format!("the line has more than {} characters", LONGEST_LINE - 1),
            ));
        }
        match line.dialect {
            Dialect::Grbl => self.grbl(&line.text, view),
            Dialect::RepRap => self.reprap(&line.text, view),
        }
    }

    /// The answer to a line that is refused, also if that is found after [`Engine::line`].
    pub(in crate::bridge) fn refuse(&mut self, dialect: Dialect, refusal: &Refusal) -> String {
        if let Some(before) = self.before.take() {
            self.stream = before;
        }
        let why = one_line(&refusal.why);
        match dialect {
            Dialect::Grbl => format!("[MSG:{why}]\nerror:{}\n", refusal.code),
            Dialect::RepRap => format!("Error:{why}\nok\n"),
        }
    }

    /// A note that answers no line.
    pub(in crate::bridge) fn note(dialect: Dialect, text: &str) -> String {
        let text = one_line(text);
        match dialect {
            Dialect::Grbl => format!("[MSG:{text}]\n"),
            Dialect::RepRap => format!("echo:{text}\n"),
        }
    }

    /// The report of a fault, or of an emergency stop.
    pub(in crate::bridge) fn alarm(dialect: Dialect, why: &str) -> String {
        let why = one_line(why);
        match dialect {
            Dialect::Grbl => format!("ALARM:3\n[MSG:{why}; $X clears it]\n"),
            Dialect::RepRap => format!("Error:{why}; M999 clears it\n"),
        }
    }

    /// The answer to `?`.
    pub(in crate::bridge) fn report(&self, view: &View) -> String {
        grbl::report(self, view)
    }

    /// What a line of G-code asks for.
    pub(super) fn gcode(
        &mut self,
        dialect: Dialect,
        text: &str,
        view: &View,
    ) -> Result<Response, Refusal> {
        let words = command(text);
        if !view.homed && words.starts_with("G28") {
            return Ok(Response::new(String::new(), vec![Order::Home]));
        }
        let before = self.stream.clone();
        let job = self.stream.line(text)?;
        if job.first_change_of_mode().is_some() {
            self.stream = before;
            return Err(Refusal::new(
                20,
                "M780 and M781 are not for senders: change the mode on the page, or in a job of sim, drive or serve",
            ));
        }
        let is_shifted = self.stream.zero() != before.zero();
        if !view.homed && (!job.steps.is_empty() || is_shifted) {
            self.stream = before;
            return Err(Refusal::locked(
                "the joint angles are unknown: home first, $H or G28",
            ));
        }
        let mut notes = String::new();
        for warning in &job.warnings {
            if let WarningKind::UnknownCode(_) | WarningKind::PenSpeeds { .. } = warning.kind {
                notes += &Self::note(dialect, &warning.to_string());
            }
        }
        let rapid = f64::from(self.settings.motion.max_speed);
        let moves: Vec<Move> = job
            .moves(rapid)
            .zip(&job.steps)
            .map(|(next, step)| Move {
                tag: if is_rapid(step) { RAPID } else { 0 },
                ..next
            })
            .collect();
        let mut moves = divided(before.position(), &moves);
        let ends = ["M2", "M30"].contains(&words.as_str());
        let level = if ends { 0 } else { share(self.stream.level()) };
        if moves.is_empty() && level != self.level && view.armed {
            moves.push(Move {
                tag: 0,
                tool: level,
                kind: MoveKind::Dwell {
                    duration: LEVEL_CHANGE,
                },
            });
        }
        self.level = moves.last().map_or(self.level, |last| last.tool);
        self.before = Some(before);
        let mut orders = Vec::new();
        if !moves.is_empty() {
            orders.push(Order::Moves(moves));
        }
        if let Some(stop) = job.stops.first() {
            let place = if stop.ends_line() { orders.len() } else { 0 };
            orders.insert(place, Order::Pause);
            notes += &Self::note(dialect, &format!("{} waits for ~ or M108", stop.code));
        }
        if ends {
            orders.push(Order::Finish);
        }
        Ok(Response::new(notes, orders))
    }

    /// A jog: the words of a straight motion in its own modes, with the tool up.
    pub(super) fn jog(&mut self, words: &str) -> Result<Vec<Move>, Refusal> {
        let mut stream = self.stream.clone();
        let job = stream.line(&format!("G1 {words}"))?;
        let from = stream.position();
        let rapid = f64::from(self.settings.motion.max_speed);
        let lines = job
            .steps
            .iter()
            .all(|step| matches!(step.action, Action::Line { .. }));
        if !lines {
            return Err(Refusal::new(16, "a jog is straight: give X, Y and F"));
        }
        let moves = job
            .moves(rapid)
            .map(|next| Move { tool: 0, ..next })
            .collect();
        self.before = Some(self.stream.clone());
        if let Some(end) = from {
            self.stream.set_position(end);
        }
        self.level = 0;
        Ok(moves)
    }
}

/// Whether a step is a G0.
fn is_rapid(step: &Step) -> bool {
    matches!(step.action, Action::Line { feed: None, .. })
}

/// A share as a level of the tool.
fn share(level: f64) -> u16 {
    (level * f64::from(FULL_TOOL)).round() as u16
}

/// A text that fits into one line of an answer.
fn one_line(text: &str) -> String {
    text.trim_end_matches('.')
        .replace(['\n', '\r', '[', ']'], " ")
}
