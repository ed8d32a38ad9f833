//! Why a job is refused, and which parts of it are skipped.

use std::fmt;

/// Why a job is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JobError {
    /// A line that is not valid.
    #[error("line {line}: \"{text}\": {reason}")]
    Line {
        /// The line, from 1.
        line: u32,
        /// The text of the line.
        text: String,
        /// The error in it.
        reason: GcodeError,
    },
    /// No line moves the tool.
    #[error(
        "the job has no motion: no line moves the tool; check that it is a G-code file with G0 to G3"
    )]
    NoMotion,
}

/// The error in a line of G-code.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GcodeError {
    /// The line is no G-code.
    #[error("{0}")]
    Syntax(String),
    /// An open parenthesis is not closed.
    #[error("the comment is not closed; add the missing )")]
    OpenComment,
    /// The checksum does not match the line.
    #[error(
        "the checksum is {stated}, but the line's is {found}, so the line was changed or damaged; \
         if you changed it, remove the * and the number after it"
    )]
    Checksum {
        /// The checksum after the star.
        stated: u8,
        /// The checksum of the line.
        found: u8,
    },
    /// A G code that is not supported.
    #[error(
        "{0} is not supported; use G0 G1 G2 G3 G4 G20 G21 G28 G90 G91 and G92, or remove the line"
    )]
    UnknownGCode(String),
    /// Two G codes that both use the coordinates.
    #[error("{0} and {1} cannot be on the same line; write them on two lines")]
    Conflict(String, String),
    /// The same letter twice.
    #[error("{0} occurs twice")]
    Repeated(char),
    /// A word that no code of the line uses.
    #[error("{0} has no meaning on this line; remove it")]
    StrayWord(char),
    /// Coordinates before any of G0 to G3.
    #[error("coordinates without a motion; start the line with G0, G1, G2 or G3")]
    NoMode,
    /// A motion before any feed rate.
    #[error("no feed rate yet; give one, such as F1200 for 1200 mm/min")]
    NoFeed,
    /// F zero or below.
    #[error("the feed rate must be above zero")]
    Feed,
    /// A coordinate beyond 1 km [m].
    #[error("{0:?} m is out of reach of any arm; check the units (G20 inch, G21 mm)")]
    TooFar(f64),
    /// Neither P nor S, or a time that is negative or too long.
    #[error(
        "a dwell takes P in ms or S in s, from 0 to {} s",
        fivebar_firmware::planner::LONGEST
    )]
    Dwell,
    /// I and J together with R, or none of them.
    #[error("an arc takes I and J, or R")]
    ArcForm,
    /// The radius is zero.
    #[error("the arc's radius is zero")]
    ArcRadius,
    /// Start and end have different distances from the centre [mm].
    #[error(
        "the arc starts {0:.4} mm from its centre and ends {1:.4} mm from it; the two must agree"
    )]
    ArcEnds(f64, f64),
    /// R is less than half the chord, or the end is the start, so that no single circle fits.
    #[error("no single circle of radius R passes through both ends of the arc; give I and J")]
    ArcChord,
}

/// A part of the job that is skipped.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// The line, from 1.
    pub line: u32,
    /// What is skipped.
    pub kind: WarningKind,
}

/// What is skipped.
#[derive(Clone, Debug, PartialEq)]
pub enum WarningKind {
    /// An M or T code that is not supported.
    UnknownCode(String),
    /// Z, because the arm moves in a plane. Only the first Z gives a warning.
    Height,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: ", self.line)?;
        match &self.kind {
            WarningKind::UnknownCode(code) => write!(f, "{code} is not supported and is skipped"),
            WarningKind::Height => {
                write!(
                    f,
                    "Z is skipped here and below, because the arm moves in a plane"
                )
            }
        }
    }
}

/// Text of a job as messages quote it: at most 60 characters, control characters replaced.
pub(super) fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    let visible = text
        .trim()
        .chars()
        .map(|c| if c.is_control() { '\u{FFFD}' } else { c });
    let mut short: String = visible.clone().take(LONGEST).collect();
    if visible.count() > LONGEST {
        short.push('…');
    }
    short
}
