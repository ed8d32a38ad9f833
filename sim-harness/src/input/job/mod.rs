//! G-code jobs: from text to steps of the tool in metres, each with its line.
//!
//! Supported: G0 G1 G2 G3 (I J or R) G4 (P in ms, S in s) G20 G21 G28 G90 G91 G92, F in
//! mm/min or inch/min, M3 M4 M5 and M300 S for the pen, M2 and M30 as the end, comments in
//! parentheses and after a semicolon, line numbers and their checksums. A line with
//! coordinates only repeats the motion before. Other M codes are skipped with a warning,
//! together with their text. Anything else is refused with its line. Every step of the job
//! is kept, except steps of no length.

mod arc;
mod error;
mod interpreter;
mod words;

pub use error::{GcodeError, JobError, Warning, WarningKind};

use crate::input::text_file;
use fivebar_firmware::{Move, MoveKind};
use std::path::Path;

/// Reads the text of a job's file. G-code is ASCII, but comments have any encoding. Bytes
/// that are not UTF-8 become U+FFFD, which is refused outside comments.
///
/// # Errors
/// The file cannot be read, or is larger than 64 MiB.
pub fn read(path: &Path) -> std::io::Result<String> {
    text_file::read_bytes(path, text_file::LARGEST_GCODE)
        .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
}

/// The placement of a job in the frame of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The position of the job's (0, 0) [m].
    pub origin: [f64; 2],
    /// Metres in the plane per metre in the job. Feed rates are not scaled.
    pub scale: f64,
    /// The position to which G28 moves the tool [m].
    pub home: [f64; 2],
}

/// A job, read and placed.
///
/// ```
/// use fivebar::input::job::{Action, Job, Placement};
///
/// let placement = Placement { origin: [0.04, 0.18], scale: 1.0, home: [0.04, 0.18] }; // m
/// let job = Job::parse("G21 G90 F600\nG0 X0 Y0\nG1 X10 Y0\n", &placement)?;
/// let Some(Action::Line { to, feed }) = job.steps.last().map(|step| step.action) else {
///     panic!("the last step is a line");
/// };
/// assert!((to[0] - 0.05).abs() < 1e-12 && (feed.unwrap_or(0.0) - 0.01).abs() < 1e-12); // m, m/s
/// # Ok::<(), fivebar::input::job::JobError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The steps, in order.
    pub steps: Vec<Step>,
    /// The parts that are skipped.
    pub warnings: Vec<Warning>,
}

/// One action of the tool, with its line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The line of the file, from 1.
    pub line: u32,
    /// The tool's level during the action, 0…1: 0 is a pen that is up or a tool that is off, 1 a
    /// pen that is down or a tool at full power.
    pub tool: f64,
    /// The action.
    pub action: Action,
}

/// An action of the tool. Positions are of the tool in the frame of the base [m].
#[derive(Clone, Copy, Debug, PartialEq)]
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
}

impl Step {
    /// Whether the tool is down or on during the action.
    pub fn draws(&self) -> bool {
        self.tool > 0.0
    }
}

impl Action {
    /// The position of the tool afterwards [m]; none for a dwell.
    pub fn end(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Line { to, .. } | Self::Arc { to, .. } => Some(to),
            Self::Dwell { .. } => None,
        }
    }
}

impl Job {
    /// Reads G-code.
    ///
    /// # Errors
    /// The first line that is not valid, or a job without motion.
    pub fn parse(text: &str, placement: &Placement) -> Result<Self, JobError> {
        interpreter::interpret(text, placement)
    }

    /// The job as moves for the planner, tagged with their lines, rapid ones at
    /// `rapid_speed` [m/s].
    pub fn moves(&self, rapid_speed: f64) -> impl Iterator<Item = Move> {
        let single = |[x, y]: [f64; 2]| [x as f32, y as f32];
        self.steps.iter().map(move |step| Move {
            tag: step.line,
            kind: match step.action {
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
            },
        })
    }

    /// Whether the moves of a line draw.
    pub fn draws(&self, line: u32) -> bool {
        let first = self.steps.partition_point(|step| step.line < line);
        self.steps
            .get(first)
            .is_some_and(|step| step.line == line && step.draws())
    }
}
