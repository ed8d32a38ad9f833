//! The modes that G codes set, and the codes that are refused because they would change the
//! drawing.

use super::GcodeError;
use super::words::{Code, spelled};

/// The motion mode. It lasts until another one is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MotionMode {
    Rapid,
    Line,
    Clockwise,
    CounterClockwise,
}

/// What a line does with its coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CoordinateUse {
    Motion(MotionMode),
    Dwell,
    Home,
    Shift,
    /// G92.1, G92.2 and G92.3, by their decimal.
    ShiftAgain(u32),
    Table,
}

/// The modes of a job.
#[derive(Clone, Debug)]
pub(super) struct Modes {
    /// Metres per unit of the file.
    pub(super) unit: f64,
    pub(super) relative: bool,
    /// Whether I and J are coordinates, by G90.1, and no offsets from the arc's start.
    pub(super) absolute_centers: bool,
    pub(super) motion: Option<MotionMode>,
    /// The work coordinate system, once a line names one.
    system: Option<Code>,
}

/// What one line's codes ask for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineModes {
    pub(super) coordinate_use: Option<CoordinateUse>,
    /// G53: the coordinates of this line are the machine's.
    pub(super) machine: bool,
    /// G43: the length of the tool, which no table of this machine has.
    pub(super) tool_length: bool,
}

impl Modes {
    pub(super) fn new() -> Self {
        Self {
            unit: 1e-3,
            relative: false,
            absolute_centers: false,
            motion: None,
            system: None,
        }
    }

    /// The difference of an arc's radii that the decimals of a file explain [m]: files in millimetres have two
    /// decimals or more, those in inches three.
    pub(super) fn arc_rounding(&self) -> f64 {
        if self.unit > 1e-3 { 6e-5 } else { 2e-5 }
    }

    /// Sets the modes; returns what the line does with its coordinates.
    pub(super) fn set(&mut self, codes: &[Code]) -> Result<LineModes, GcodeError> {
        let mut line = LineModes::default();
        let mut used_by: Option<Code> = None;
        for &code in codes {
            let coordinate_use = match code {
                ('G', 0, 0) => CoordinateUse::Motion(MotionMode::Rapid),
                ('G', 1, 0) => CoordinateUse::Motion(MotionMode::Line),
                ('G', 2, 0) => CoordinateUse::Motion(MotionMode::Clockwise),
                ('G', 3, 0) => CoordinateUse::Motion(MotionMode::CounterClockwise),
                ('G', 4, 0) => CoordinateUse::Dwell,
                ('G', 28, 0) => CoordinateUse::Home,
                ('G', 92, 0) => CoordinateUse::Shift,
                ('G', 92, decimal @ 1..=3) => CoordinateUse::ShiftAgain(decimal),
                ('G', 10, 0) => CoordinateUse::Table,
                other => {
                    line.machine |= other == ('G', 53, 0);
                    line.tool_length |= other == ('G', 43, 0);
                    self.set_one(other)?;
                    continue;
                }
            };
            if let Some(other) = used_by {
                return Err(GcodeError::Conflict(spelled(other), spelled(code)));
            }
            used_by = Some(code);
            line.coordinate_use = Some(coordinate_use);
        }
        if let Some(CoordinateUse::Motion(motion)) = line.coordinate_use {
            self.motion = Some(motion);
        }
        Ok(line)
    }

    /// The number of the work coordinate system as P of G10 has it: G54 is 1.
    pub(super) fn system(&self) -> u32 {
        match self.system {
            Some((_, code, decimal)) => code - 53 + decimal,
            None => 1,
        }
    }

    /// Sets the mode of a code that uses no coordinates.
    fn set_one(&mut self, code: Code) -> Result<(), GcodeError> {
        match code {
            ('G', 20 | 70, 0) => self.unit = 25.4e-3,
            ('G', 21 | 71, 0) => self.unit = 1e-3,
            ('G', 90, 0) => self.relative = false,
            ('G', 91, 0) => self.relative = true,
            ('G', 90, 1) => self.absolute_centers = true,
            ('G', 91, 1) => self.absolute_centers = false,
            ('G', 54..=59, _) => match self.system {
                Some(system) if system != code => {
                    return Err(GcodeError::SecondSystem(spelled(code), spelled(system)));
                }
                _ => self.system = Some(code),
            },
            // Machine coordinates, the X-Y plane, no cutter radius, no tool length, no canned
            // cycle, no polar coordinates, no scale, no turn, path modes, feed per minute, constant spindle speed, return levels of canned
            // cycles: this machine is like that.
            ('G', 15 | 17 | 40 | 43 | 49 | 50 | 53 | 61 | 64 | 69 | 80 | 94 | 97..=99, 0)
            | ('G', 61, 1) => {}
            other => return Err(refusal(other)),
        }
        Ok(())
    }
}

fn refusal(code: Code) -> GcodeError {
    let why = match code {
        ('G', 18 | 19, 0) => "selects a plane with Z, and the arm moves in X and Y: draw in G17",
        ('G', 41 | 42, _) => {
            "asks for an offset by the cutter's radius, which is not added here: let the program \
             that writes the file add it"
        }
        ('G', 73 | 76 | 81..=89, _) => {
            "is a canned cycle of drilling: let the program that writes the file expand cycles"
        }
        ('G', 93 | 95, 0) => "is another unit of F: use G94, units per minute",
        ('G', 5, _) => "is a spline: let the program that writes the file make arcs or lines of it",
        _ => return GcodeError::UnknownGCode(spelled(code)),
    };
    GcodeError::ChangesDrawing(spelled(code), why)
}
