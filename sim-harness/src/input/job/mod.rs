//! G-code jobs: text in, steps of the tool in metres out, each with the line it is from.
//!
//! Understood: G0 G1 G2 G3 (I J or R) G4 (P in ms, S in s) G20 G21 G28 G90 G91 G92, F in
//! mm/min or inch/min, M3 M4 M5 and M300 S for the pen, M2 and M30 as the end, comments
//! in parentheses and after a semicolon, line numbers and their checksums, and lines of
//! coordinates alone, which repeat the motion before. Other M codes are skipped with a
//! warning, their text too; anything else is refused with its line. Nothing of a job is
//! dropped: a step of no length is no motion, and every other one is kept.

mod arc;
mod error;
mod interpreter;
mod words;

pub use error::{JobError, Reason, Warning, WarningKind};

use fivebar_firmware::{Move, MoveKind};
use std::path::Path;

/// The text of a job's file. G-code is ASCII, but comments come in any encoding: what is not
/// UTF-8 becomes U+FFFD, which is refused with its line anywhere but in a comment.
///
/// # Errors
/// The file cannot be read.
pub fn read(path: &Path) -> std::io::Result<String> {
    std::fs::read(path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
}

/// Where a job's coordinates lie in the frame of the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Where the job's (0, 0) is [m].
    pub origin: [f64; 2],
    /// Metres in the plane per metre in the job. Feed rates are not scaled.
    pub scale: f64,
    /// Where G28 sends the tool [m].
    pub home: [f64; 2],
}

/// A job, read and placed.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// What the tool does, in order.
    pub steps: Vec<Step>,
    /// What was skipped.
    pub warnings: Vec<Warning>,
}

/// One thing the tool does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The line of the source that asks for it, from 1.
    pub line: u32,
    /// Whether the pen is down meanwhile.
    pub pen_down: bool,
    /// What it does.
    pub action: Action,
}

/// What a step does. Positions are of the tool in the frame of the base [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Straight to a point.
    Line {
        /// The end [m].
        to: [f64; 2],
        /// Speed [m/s]; as fast as the arm may where there is none.
        feed: Option<f64>,
    },
    /// Along a circle; a full turn where the end is the start.
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
    /// Stand still.
    Dwell {
        /// For how long [s].
        duration: f64,
    },
}

impl Action {
    /// Where the tool is afterwards [m]; none where it stays.
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
    /// The first line that cannot be done as written, or a job without motion.
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

    /// Whether the pen is down on the moves of a line.
    pub fn pen_down(&self, line: u32) -> bool {
        let first = self.steps.partition_point(|step| step.line < line);
        self.steps
            .get(first)
            .is_some_and(|step| step.line == line && step.pen_down)
    }
}
