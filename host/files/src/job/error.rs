//! Why a job is refused, and which parts of it are skipped.

use super::Dialect;
use crate::budget::OverBudget;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
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
    /// A drawing or a picture that cannot be drawn.
    #[error("{0}")]
    Drawing(String),
    /// Copies of G-code.
    #[error(
        "copies are of drawings: the lines of copied G-code would no longer be those of its file; draw it once more elsewhere"
    )]
    Copies,
    /// The job was read in a process of its own, which has refused it or has needed more than it may.
    #[error("{0}")]
    Refused(String),
    /// The file has another format.
    #[error("this is {name}, and no G-code, SVG, DXF, HPGL, PNG or JPEG: {remedy}")]
    Format {
        /// The format.
        name: &'static str,
        /// How to make a job of it.
        remedy: &'static str,
    },
}

/// The error in a line of G-code.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GcodeError {
    /// The job is too long.
    #[error(transparent)]
    TooMuch(#[from] OverBudget),
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
    /// A G code that would change the drawing, and why.
    #[error("{0} {1}")]
    ChangesDrawing(String, &'static str),
    /// A second work coordinate system.
    #[error(
        "{0} selects another work coordinate system than {1}, and where it lies is not known: use \
         one system, and G92 to shift it"
    )]
    SecondSystem(String, String),
    /// M97 to M99.
    #[error(
        "{0} calls or ends a subprogram; let the program that writes the file write its lines out"
    )]
    Subprogram(String),
    /// An arc on which the tool touches down or lifts.
    #[error(
        "the tool touches down or lifts along this arc; move Z before or after it, or give another \
         height with --pen-height"
    )]
    Helix,
    /// A number with an exponent.
    #[error(
        "a number has an exponent, such as 1e-5, which G-code does not know; if E is the \
         extruder's, write a space before it"
    )]
    Exponent,
    /// Two G codes that both use the coordinates.
    #[error("{0} and {1} cannot be on the same line; write them on two lines")]
    Conflict(String, String),
    /// The same letter twice.
    #[error("{0} occurs twice")]
    Repeated(char),
    /// A word that no code of the line uses.
    #[error("{0} has no meaning on this line; remove it")]
    StrayWord(char),
    /// A word that moves an axis of another machine.
    #[error("{0} moves an axis that this arm does not have: let the program write X, Y and Z only")]
    NoAxis(char),
    /// Coordinates before any of G0 to G3.
    #[error("coordinates without a motion; start the line with G0, G1, G2 or G3")]
    NoMode,
    /// A motion before any feed rate.
    #[error("no feed rate yet; give one, such as F1200 for 1200 mm/min")]
    NoFeed,
    /// F zero or below.
    #[error("the feed rate must be above zero")]
    Feed,
    /// S below zero.
    #[error("the tool's speed or power must not be below zero")]
    Power,
    /// A coordinate beyond 1 km [m].
    #[error("{0:?} m is out of reach of any arm; check the units (G20 inch, G21 mm)")]
    TooFar(f64),
    /// Neither P nor S, or a time that is negative or too long.
    #[error(
        "a dwell takes P in {} or S in s, from 0 to {} s{}",
        dwell_unit(*.0),
        fivebar_firmware::planner::LONGEST,
        match .0 { Dialect::Grbl => "; with --dialect reprap P is in ms", Dialect::RepRap => "" }
    )]
    Dwell(Dialect),
    /// Not both sides of the elbows, or another number than 1 and -1.
    #[error("M780 takes the sides of both elbows, such as I1 J-1: 1 is left, -1 is right")]
    Elbows,
    /// Not all of X, Y and P, or a time that is not above zero.
    #[error("M781 takes the end of the crossing and its time in s, such as X30 Y12 P0.3")]
    Crossing,
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

/// A note on a job: what is skipped, or how it is read where that is not certain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Warning {
    /// The first line, from 1; 0 if the note is on the whole job.
    pub line: u32,
    /// How often it was found.
    pub count: u32,
    /// What was found.
    pub kind: WarningKind,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum WarningKind {
    /// An M code that is not supported.
    UnknownCode(String),
    /// Z, where it does not move the tool.
    Height,
    /// A tool's length, of which there is no table.
    ToolLength,
    /// A stop for the user.
    Stop(String),
    /// The unit of G4 P, and the sign of RepRap with its line.
    DwellUnit(Dialect, Option<(u32, String)>),
    /// The height at which the tool touches down [m], which was guessed.
    PenHeight(f64),
    /// Any S above 0 puts a tool of two states down.
    PenDown,
    /// The two S of a pen, by the motions at each.
    PenSpeeds {
        /// S with the pen down.
        down: f64,
        /// S with the pen up.
        up: f64,
    },
    /// A slicer draws before its first layer, which begins in this line.
    Purge(u32),
    /// The travel after the last stroke is left out.
    Parking,
    /// No word moves or switches the tool.
    NoToolWords,
    /// A motion before any F.
    NoFeed,
    /// Another speed was asked for than F.
    FeedReplaced,
    /// A line that begins with a slash.
    BlockDelete,
    /// Blanks within a number.
    Blanks,
    /// A word of an axis that the arm does not have, which does not move.
    NoAxis(char),
    /// Speeds above this one [m/s], the arm's greatest.
    Speed(f64),
    /// The arm ends in its other assembly mode.
    OtherAssembly,
    /// The text is UTF-16.
    Utf16,
    /// The pens of a drawing that has several.
    Pens(Vec<String>),
    /// What of a drawing is not read, by its name in the file.
    LeftOut(String),
    /// Notes of more kinds than are kept.
    Others,
    /// A part of a drawing that is drawn otherwise or not at all.
    Drawing(Cow<'static, str>),
}

impl Warning {
    /// A warning of this line.
    pub fn at(line: u32, kind: WarningKind) -> Self {
        Self {
            line,
            count: 1,
            kind,
        }
    }
}

fn dwell_unit(dialect: Dialect) -> &'static str {
    match dialect {
        Dialect::Grbl => "s",
        Dialect::RepRap => "ms",
    }
}

impl fmt::Display for Warning {
    #[expect(clippy::too_many_lines, reason = "a list of sentences")]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        match &self.kind {
            WarningKind::UnknownCode(code) => write!(f, "{code} is not supported and is skipped"),
            WarningKind::Height => {
                return write!(
                    f,
                    "Z is skipped here and below, because the arm moves in a plane"
                );
            }
            WarningKind::ToolLength => {
                write!(f, "G43 changes nothing, because the arm moves in a plane")
            }
            WarningKind::Stop(code) => write!(
                f,
                "{code} stops and waits for you on a machine; a simulation goes on at once"
            ),
            WarningKind::DwellUnit(dialect, sign) => {
                return write_dwell_unit(f, *dialect, sign.as_ref());
            }
            WarningKind::PenHeight(height) => return write_pen_height(f, *height),
            WarningKind::PenDown => {
                return f.write_str(
                    "any S above 0 puts the tool down, because it has two states only; down_s and \
                     up_s in [tool_output] of the robot file state another rule",
                );
            }
            WarningKind::PenSpeeds { down, up } => return write_pen_speeds(f, *down, *up),
            WarningKind::Purge(layer) => return write_purge(f, *layer),
            WarningKind::Parking => {
                return f.write_str(
                    "the travel from here on is left out, because the arm cannot do it and nothing \
                     is drawn behind it",
                );
            }
            WarningKind::NoToolWords => {
                return f.write_str(
                    "no code moves or switches the tool: it is down on G1, G2 and G3, and up on G0",
                );
            }
            WarningKind::NoFeed => f.write_str(
                "no F gives a speed: what follows is drawn at the arm's greatest speed, or at that of --speed",
            ),
            WarningKind::FeedReplaced => f.write_str("--speed takes the place of F"),
            WarningKind::BlockDelete => {
                f.write_str("a line that begins with / is carried out, as with block delete off")
            }
            WarningKind::Blanks => f.write_str("blanks within a number are left out: X1 0 is X10"),
            WarningKind::NoAxis(axis) => {
                write!(f, "{axis}0 is skipped, because the arm has no axis {axis}")
            }
            WarningKind::Speed(limit) => write!(
                f,
                "the feed rate is above the arm's greatest speed and becomes {limit} m/s (F{:.0})",
                limit * 60e3
            ),
            WarningKind::OtherAssembly => {
                return f.write_str(
                    "the arm ends in its other assembly mode: cross back before it is switched off, \
                     because after homing it is supposed in that of home",
                );
            }
            WarningKind::Utf16 => {
                return f.write_str(
                    "the file is UTF-16 text and is read as such; other programs want UTF-8",
                );
            }
            WarningKind::Pens(pens) => {
                return write!(
                    f,
                    "the pens are {}, in this order; a machine waits for you between them, a \
                     simulation goes on at once",
                    pens.join(", ")
                );
            }
            WarningKind::LeftOut(what) => write!(f, "left out: {what}; convert it to lines first"),
            WarningKind::Others => f.write_str("here and below are more notes, of other kinds"),
            WarningKind::Drawing(what) => f.write_str(what),
        }?;
        if self.count > 1 {
            write!(f, " ({} times)", self.count)?;
        }
        Ok(())
    }
}

/// Which unit `P` of `G4` has, and by which line's sign, if one decides it.
fn write_dwell_unit(
    f: &mut fmt::Formatter<'_>,
    dialect: Dialect,
    sign: Option<&(u32, String)>,
) -> fmt::Result {
    match (dialect, sign) {
        (Dialect::RepRap, Some((line, sign))) => write!(
            f,
            "P of G4 is in milliseconds, as RepRap has it, because of {sign} in line {line}; \
             --dialect grbl makes it seconds"
        ),
        (Dialect::RepRap, None) => f.write_str(
            "P of G4 is in milliseconds, as RepRap has it; --dialect grbl makes it seconds",
        ),
        (Dialect::Grbl, _) => f.write_str(
            "P of G4 is in seconds, as Grbl has it; --dialect reprap makes it milliseconds",
        ),
    }
}

fn write_purge(f: &mut fmt::Formatter<'_>, layer: u32) -> fmt::Result {
    write!(
        f,
        "what is drawn from here to line {layer}, before the first layer, is the slicer's purge \
         line: take it out of its start code if the paper should not have it"
    )
}

fn write_pen_height(f: &mut fmt::Formatter<'_>, height: f64) -> fmt::Result {
    write!(
        f,
        "the tool is down up to Z{}, the middle between the file's heights, because all of them \
         are on one side of Z0; --pen-height gives another height",
        (1e6 * height).round() / 1e3
    )
}

fn write_pen_speeds(f: &mut fmt::Formatter<'_>, down: f64, up: f64) -> fmt::Result {
    write!(
        f,
        "S{down} is taken as pen down and S{up} as pen up, because the arm mostly travels at S{up}; \
         down_s and up_s in [tool_output] of the robot file decide otherwise"
    )
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
