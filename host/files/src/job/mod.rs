//! Jobs: from the text of a file to steps of the tool in metres, each with its line.
//!
//! G-code as Grbl, LinuxCNC and RepRap programs write it; docs/use/gcode.md lists every code with its
//! meaning. What would change the drawing is refused with its line; what is skipped is noted. SVG
//! drawings are read by the module `svg`. Every step of a job is kept, except steps of no length.

pub mod arc;
mod drawing;
mod dxf;
mod error;
mod evidence;
mod format;
mod hpgl;
mod interpreter;
mod modes;
mod motion;
mod options;
mod order;
mod pen_speeds;
mod reader;
mod stop;
mod stream;
#[cfg(feature = "svg")]
mod svg;
mod text;
mod tool;
mod trace;
mod words;

pub use error::{GcodeError, JobError, Warning, WarningKind};
pub use options::{Dialect, JobOptions, ToolLevels};
pub use reader::JobReader;
pub use stop::{Pause, Stop};
pub use stream::JobStream;
pub use text::read;
pub use tool::ToolWords;
pub use trace::Trace;

use format::Format;

use fivebar_firmware::{FULL_TOOL, Move, MoveKind};
use fivebar_kinematics::five_bar::WorkingMode;
use serde::{Deserialize, Serialize};

/// The built-in demonstration, in G-code.
pub const DEMONSTRATION: &str = include_str!("../../jobs/fivebar.gcode");
/// A short built-in drawing, in G-code.
pub const PETAL: &str = include_str!("../../jobs/petal.gcode");

/// The endings of files that are read as jobs: G-code, then drawings, plots and pictures.
pub const ENDINGS: [&str; 17] = [
    "gcode", "nc", "ngc", "gc", "tap", "cnc", "txt", "svg", "svgz", "dxf", "hpgl", "hgl", "hpg",
    "plt", "png", "jpg", "jpeg",
];

/// Most different notes on a job.
const MOST_NOTES: usize = 100;

/// The placement of a job in the frame of the base.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// The position of the job's (0, 0) [m].
    pub origin: [f64; 2],
    /// Metres in the plane per metre in the job. Feed rates are not scaled.
    pub scale: f64,
    /// The angle by which the job is turned about its (0, 0), counter-clockwise [rad].
    pub turn: f64,
    /// The position to which G28 moves the tool [m].
    pub home: [f64; 2],
}

impl Placement {
    /// A point of the job in the frame of the base [m].
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.turn.sin_cos();
        [
            self.origin[0] + self.scale * (cos * x - sin * y),
            self.origin[1] + self.scale * (sin * x + cos * y),
        ]
    }

    /// The point of the job that [`Placement::place`] takes to `point` [m].
    pub fn unplace(&self, point: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.turn.sin_cos();
        let [x, y] = [0, 1].map(|axis| (point[axis] - self.origin[axis]) / self.scale);
        [cos * x + sin * y, cos * y - sin * x]
    }
}

/// A job, read and placed.
///
/// ```
/// use fivebar_files::job::{Action, Job, Placement};
///
/// let origin = [0.04, 0.18]; // m
/// let placement = Placement { origin, scale: 1.0, turn: 0.0, home: origin };
/// let job = Job::parse("G21 G90 F600\nG0 X0 Y0\nG1 X10 Y0\n", &placement)?;
/// let Some(Action::Line { to, feed }) = job.steps.last().map(|step| step.action) else {
///     panic!("the last step is a line");
/// };
/// assert!((to[0] - 0.05).abs() < 1e-12 && (feed.unwrap_or(0.0) - 0.01).abs() < 1e-12); // m, m/s
/// # Ok::<(), fivebar_files::job::JobError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The steps, in order.
    pub steps: Vec<Step>,
    /// The stops, in order.
    pub stops: Vec<Stop>,
    /// What is skipped, and what was guessed.
    pub warnings: Vec<Warning>,
    /// Whether the job is an SVG, HPGL, DXF or a picture. Its steps then count strokes in place of lines: stroke n has the
    /// number 2n, the motion to it 2n − 1.
    pub is_drawing: bool,
    /// Whether a point depends on where home is, so that the job has another shape elsewhere.
    pub depends_on_home: bool,
}

/// One action of the tool, with its line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The line of the file, from 1; 0 for the motion to the job's start, which no line asks for.
    pub line: u32,
    /// The tool's level during the action, 0…1: 0 is a pen that is up or a tool that is off, 1 a
    /// pen that is down or a tool at full power.
    pub tool: f64,
    /// The action.
    pub action: Action,
}

/// An action of the tool. Positions are of the tool in the frame of the base [m].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// A straight line.
    Line {
        /// The end [m].
        to: [f64; 2],
        /// Speed [m/s]; none: the arm's greatest speed.
        feed: Option<f64>,
    },
    /// An arc; a full turn if the end is the start.
    Arc {
        /// The end [m].
        to: [f64; 2],
        /// The circle's centre [m].
        center: [f64; 2],
        /// The sense of rotation.
        clockwise: bool,
        /// Speed [m/s].
        feed: f64,
    },
    /// A pause.
    Dwell {
        /// Its length [s].
        duration: f64,
    },
    /// A change to this working mode; the tool goes back to its place.
    ChangeMode(WorkingMode),
    /// Straight through a singularity of type 2 to the other assembly mode.
    Cross {
        /// The end [m].
        to: [f64; 2],
        /// Its time [s].
        time: f64,
    },
}

impl Step {
    /// Whether the tool is down or on during the action.
    pub fn draws(&self) -> bool {
        self.tool > 0.0
    }

    /// The step as a move, a rapid one at `rapid_speed` [m/s]. None for a change of the working or the
    /// assembly mode, whose moves depend on the arm.
    pub fn as_move(&self, rapid_speed: f64) -> Option<Move> {
        let single = |[x, y]: [f64; 2]| [x as f32, y as f32];
        let kind = match self.action {
            Action::Line { to, feed } => MoveKind::Line {
                to: single(to),
                feed: feed.unwrap_or(rapid_speed) as f32,
            },
            Action::Arc {
                to,
                center,
                clockwise,
                feed,
            } => MoveKind::Arc {
                to: single(to),
                center: single(center),
                clockwise,
                feed: feed as f32,
            },
            Action::Dwell { duration } => MoveKind::Dwell {
                duration: duration as f32,
            },
            Action::ChangeMode(_) | Action::Cross { .. } => return None,
        };
        Some(Move {
            tag: self.line,
            tool: tool_level(self.tool),
            kind,
        })
    }
}

impl Action {
    /// The position of the tool afterwards [m]; none if it stays or comes back.
    pub fn end(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Line { to, .. } | Self::Arc { to, .. } | Self::Cross { to, .. } => Some(to),
            Self::Dwell { .. } | Self::ChangeMode(_) => None,
        }
    }

    /// The length of its path, with the tool at `from` before it [m].
    pub fn length(&self, from: [f64; 2]) -> f64 {
        match *self {
            Self::Line { to, .. } | Self::Cross { to, .. } => {
                (to[0] - from[0]).hypot(to[1] - from[1])
            }
            Self::Arc {
                to,
                center,
                clockwise,
                ..
            } => {
                let (radius, angle) = arc::sweep(from, to, center, clockwise);
                radius * angle
            }
            Self::Dwell { .. } | Self::ChangeMode(_) => 0.0,
        }
    }
}

impl Job {
    /// Reads G-code, SVG, HPGL, DXF or a picture as [`JobOptions::default`] has it.
    ///
    /// # Errors
    /// The first line that is not valid, or a job without motion.
    pub fn parse(text: &str, placement: &Placement) -> Result<Self, JobError> {
        Self::parse_with(text, placement, &JobOptions::default())
    }

    /// Reads G-code, SVG, HPGL, DXF or a picture, by the first characters of the text.
    ///
    /// # Errors
    /// As [`Job::parse`].
    pub fn parse_with(
        text: &str,
        placement: &Placement,
        options: &JobOptions,
    ) -> Result<Self, JobError> {
        let (text, was_utf16) = text::without_mark(text);
        let format = format::of(text);
        if format == Format::Gcode && options.copies != [1, 1] {
            return Err(JobError::Copies);
        }
        let mut job = match format {
            Format::Gcode => interpreter::interpret(text, placement, options)?,
            Format::Svg => svg_job(text, placement, options)?,
            Format::Dxf => dxf::interpret(text, placement, options)?,
            Format::Hpgl => hpgl::interpret(text, placement, options)?,
            Format::Picture => trace::interpret(text, placement, options)?,
            Format::Foreign { name, remedy } => return Err(JobError::Format { name, remedy }),
        };
        if was_utf16 {
            job.warnings.insert(0, Warning::at(0, WarningKind::Utf16));
        }
        Ok(job)
    }

    /// Adds a note, or counts it, if the job has the same one. Notes of very many kinds become one.
    fn note(&mut self, line: u32, kind: WarningKind) {
        let is_room = self.warnings.len() < MOST_NOTES;
        match self.warnings.iter_mut().find(|other| other.kind == kind) {
            Some(same) => same.count += 1,
            None if is_room || kind == WarningKind::Others => {
                self.warnings.push(Warning::at(line, kind));
            }
            None => self.note(line, WarningKind::Others),
        }
    }

    /// The lines, arcs and pauses of the job as moves for the planner, tagged with their lines, rapid
    /// ones at `rapid_speed` [m/s]. [`Scenario::moves`](super::scenario::Scenario::moves) also has the
    /// changes of the working mode, which depend on the arm.
    pub fn moves(&self, rapid_speed: f64) -> impl Iterator<Item = Move> {
        let steps = self.steps.iter();
        steps.filter_map(move |step| step.as_move(rapid_speed))
    }

    /// The first line that changes the working mode or the assembly mode.
    pub fn first_change_of_mode(&self) -> Option<u32> {
        let mut steps = self.steps.iter();
        let change = steps
            .find(|step| matches!(step.action, Action::ChangeMode(_) | Action::Cross { .. }))?;
        Some(change.line)
    }

    /// The same job placed once more: its points become those of `placement`.
    pub fn moved(&self, placement: &Placement) -> Self {
        let mut moved = self.clone();
        for step in &mut moved.steps {
            match &mut step.action {
                Action::Line { to, .. } | Action::Cross { to, .. } => *to = placement.place(*to),
                Action::Arc { to, center, .. } => {
                    *to = placement.place(*to);
                    *center = placement.place(*center);
                }
                Action::Dwell { .. } | Action::ChangeMode(_) => {}
            }
        }
        moved
    }

    /// The job without the travel after its last stroke, which is noted; none if there is none. A
    /// pause and a change of mode stay.
    pub(crate) fn without_parking(&self) -> Option<Self> {
        let last = self.steps.iter().rposition(Step::draws)?;
        let parking = self.steps.get(last + 1..)?;
        let is_travel = |step: &Step| matches!(step.action, Action::Line { .. });
        let first = parking.iter().find(|step| is_travel(step))?.line;
        if !parking
            .iter()
            .all(|step| is_travel(step) || matches!(step.action, Action::Dwell { .. }))
        {
            return None;
        }
        let mut job = self.clone();
        job.steps.truncate(last + 1);
        let rests = parking.iter().filter(|step| !is_travel(step));
        job.steps.extend(rests);
        let steps = job.steps.len();
        for stop in &mut job.stops {
            stop.before = stop.before.min(steps);
        }
        job.note(first, WarningKind::Parking);
        Some(job)
    }

    /// The length of the path at the end of each step, with the tool at `from` before them [m].
    pub fn path_lengths(&self, from: [f64; 2]) -> Vec<f64> {
        let state = (from, 0.0);
        let lengths = self.steps.iter().scan(state, |(at, length), step| {
            *length += step.action.length(*at);
            *at = step.action.end().unwrap_or(*at);
            Some(*length)
        });
        lengths.collect()
    }

    /// The job from this line on, or from this stroke of a drawing. The tool first goes, up, to where
    /// it would be there. None if no step is left.
    pub fn starting_at(&self, line: u32) -> Option<Self> {
        let line = if self.is_drawing {
            line.saturating_mul(2).saturating_sub(1)
        } else {
            line
        };
        let first = self.steps.iter().position(|step| step.line >= line)?;
        let (before, rest) = self.steps.split_at(first);
        let place = before.iter().rev().find_map(|step| step.action.end());
        let approach = place.map(|to| Step {
            line: 0,
            tool: 0.0,
            action: Action::Line { to, feed: None },
        });
        let stops = self.stops.iter().filter(|stop| stop.before >= first);
        let shift = first - usize::from(approach.is_some());
        Some(Self {
            steps: approach.into_iter().chain(rest.iter().copied()).collect(),
            stops: stops
                .map(|stop| Stop {
                    before: stop.before - shift,
                    ..stop.clone()
                })
                .collect(),
            warnings: self.warnings.clone(),
            ..*self
        })
    }

    /// Whether the moves of a line draw.
    pub fn draws(&self, line: u32) -> bool {
        let first = self.steps.partition_point(|step| step.line < line);
        let steps = self.steps.get(first..).unwrap_or_default();
        let mut of_line = steps.iter().take_while(|step| step.line == line);
        of_line.any(Step::draws)
    }
}

/// Whether the text is a drawing, whose steps count strokes.
pub(crate) fn is_drawing(text: &str) -> bool {
    matches!(
        format::of(text::without_mark(text).0),
        Format::Svg | Format::Hpgl | Format::Dxf | Format::Picture
    )
}

#[cfg(feature = "svg")]
fn svg_job(text: &str, placement: &Placement, options: &JobOptions) -> Result<Job, JobError> {
    svg::interpret(text, placement, options)
}

#[cfg(not(feature = "svg"))]
fn svg_job(_: &str, _: &Placement, _: &JobOptions) -> Result<Job, JobError> {
    let reason = "the file is XML, and SVG is read only with the feature `svg`";
    Err(JobError::Drawing(reason.into()))
}

/// The level of a move for a tool's share, 0 to 1. A tool that is on stays on.
fn tool_level(share: f64) -> u16 {
    let level = (share * f64::from(FULL_TOOL)).round() as u16;
    if share > 0.0 { level.max(1) } else { 0 }
}
