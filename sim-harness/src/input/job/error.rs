//! Why a job is refused and what of it is skipped, in sentences for its author.

use std::fmt;

/// A job that cannot be done as written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// A line that makes no sense or asks for what there is not.
    #[error("line {line}: \"{text}\": {reason}")]
    Line {
        /// The line, from 1.
        line: u32,
        /// What stands there.
        text: String,
        /// What is wrong with it.
        reason: Reason,
    },
    /// Nothing in it moves the tool.
    #[error("the job has no motion: no line moves the tool; is it a G-code file with G0 to G3?")]
    NoMotion,
}

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Reason {
    /// Not G-code.
    #[error("{0}")]
    Syntax(String),
    /// A parenthesis without its partner.
    #[error("the comment is not closed; every ( needs its )")]
    OpenComment,
    /// The line is not the one its checksum was made of.
    #[error(
        "the checksum says {stated} and the line has {found}, so it was changed or damaged on \
         its way; take the * and its number off if that was on purpose"
    )]
    Checksum {
        /// After the star.
        stated: u8,
        /// Of the line.
        found: u8,
    },
    /// A G code that is not among those understood.
    #[error(
        "{0} is not understood; there are G0 G1 G2 G3 G4 G20 G21 G28 G90 G91 and G92, so \
         write the line with these or take it out"
    )]
    UnknownGCode(String),
    /// Two G codes that both want the coordinates.
    #[error("{0} and {1} cannot share a line; write them on two")]
    Conflict(String, String),
    /// The same letter twice.
    #[error("{0} stands twice")]
    Repeated(char),
    /// A word that means nothing here.
    #[error("{0} means nothing here; take it out")]
    StrayWord(char),
    /// Coordinates before any of G0 to G3.
    #[error("coordinates without a motion; start the line with G0, G1, G2 or G3")]
    NoMode,
    /// A motion at a feed rate that was never given.
    #[error("no feed rate yet; give one, such as F1200 for 1200 mm/min")]
    NoFeed,
    /// F zero or below.
    #[error("the feed rate must be above zero")]
    Feed,
    /// A coordinate too large to mean anything.
    #[error("{0:?} m is farther than any arm; are the units right (G20 inch, G21 mm)?")]
    TooFar(f64),
    /// Neither P nor S, or one that is negative or very long.
    #[error(
        "a dwell takes P in ms or S in s, from 0 to {} s",
        fivebar_firmware::planner::LONGEST
    )]
    Dwell,
    /// Both ways of giving a circle, or neither.
    #[error("an arc takes I and J, or R")]
    ArcForm,
    /// I and J are zero, or R is.
    #[error("the arc's radius is zero")]
    ArcRadius,
    /// Start and end lie at unlike distances from the centre.
    #[error(
        "the arc starts {0:.4} mm from its centre and ends {1:.4} mm from it; the two must agree"
    )]
    ArcEnds(f64, f64),
    /// R cannot reach, or the end is the start, where R has no one answer.
    #[error("no one circle of radius R passes both ends of the arc; give I and J")]
    ArcChord,
}

/// Something in the job that is left out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// The line, from 1.
    pub line: u32,
    /// What is left out.
    pub kind: WarningKind,
}

/// What is left out.
#[derive(Clone, Debug, PartialEq)]
pub enum WarningKind {
    /// An M or T code that is not understood.
    UnknownCode(String),
    /// Heights: the arm moves in a plane. Said once, for the first.
    Height,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: ", self.line)?;
        match &self.kind {
            WarningKind::UnknownCode(code) => write!(f, "{code} is not understood and skipped"),
            WarningKind::Height => {
                write!(
                    f,
                    "Z is skipped here and below, as the arm moves in a plane"
                )
            }
        }
    }
}

/// Text of a job as it is quoted: garbage may be long and hold anything.
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
