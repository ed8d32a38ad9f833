//! The built-in robots.

use super::Robot;
use crate::source::FileError;

/// A robot file that is part of the program.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// Its name for `--robot`.
    pub name: &'static str,
    /// The text of its file.
    pub text: &'static str,
}

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        &[$(BuiltIn {
            name: $name,
            text: include_str!(concat!("../../robots/", $name, ".toml")),
        }),*]
    };
}

/// All built-in robots; the first is the default.
pub const BUILT_IN: &[BuiltIn] = built_in![
    "benchtop",
    "benchtop_belt",
    "benchtop_pen",
    "benchtop_stepper",
    "usp_2dof",
    "air_hockey",
    "haply",
    "icube",
    "pantograph_mk2",
    "duet",
    "leg",
    "classroom_servo",
];

impl BuiltIn {
    /// The default robot.
    pub const DEFAULT: &'static str = "benchtop";

    /// The built-in robot with this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        BUILT_IN.iter().find(|robot| robot.name == name)
    }

    /// Reads the robot.
    ///
    /// # Errors
    /// None: tests read every built-in robot.
    pub fn robot(&self) -> Result<Robot, FileError> {
        Robot::parse(&format!("built-in robot {}", self.name), self.text)
    }

    /// A summary of the robot: the first line of its file's leading comment.
    pub fn summary(&self) -> &'static str {
        let first = self.text.lines().next().unwrap_or_default();
        first.trim_start_matches('#').trim()
    }
}
