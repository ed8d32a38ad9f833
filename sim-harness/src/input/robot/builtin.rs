//! The robots that come with the program.

use super::Robot;
use crate::input::source::FileError;

/// A robot file that comes with the program.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// What `--robot` calls it.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
}

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        &[$(BuiltIn {
            name: $name,
            text: include_str!(concat!("../../../robots/", $name, ".toml")),
        }),*]
    };
}

/// All of them; the first is the default.
pub const BUILT_IN: &[BuiltIn] = built_in![
    "benchtop",
    "usp_2dof",
    "air_hockey",
    "haply",
    "icube",
    "pantograph_mk2",
    "duet",
];

impl BuiltIn {
    /// The one used where none is named.
    pub const DEFAULT: &'static str = "benchtop";

    /// The built-in robot of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        BUILT_IN.iter().find(|robot| robot.name == name)
    }

    /// The robot, read.
    ///
    /// # Errors
    /// None that the tests have let through.
    pub fn robot(&self) -> Result<Robot, FileError> {
        Robot::parse(&format!("built-in robot {}", self.name), self.text)
    }

    /// What the file's leading comment says of the robot, in its first line.
    pub fn summary(&self) -> &'static str {
        let first = self.text.lines().next().unwrap_or_default();
        first.trim_start_matches('#').trim()
    }
}
