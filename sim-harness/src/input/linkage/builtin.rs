//! The linkages that come with the program.

use super::DrivenLinkage;
use crate::input::source::FileError;

/// A linkage file that comes with the program.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// What the command line calls it.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
}

macro_rules! examples {
    ($($name:literal),* $(,)?) => {
        &[$(Example {
            name: $name,
            text: include_str!(concat!("../../../linkages/", $name, ".toml")),
        }),*]
    };
}

/// All of them.
pub const EXAMPLES: &[Example] = examples![
    "four_bar",
    "slider_crank",
    "inverted_slider_crank",
    "shaper",
    "five_bar",
    "stephenson",
    "prrrp",
    "scotch_yoke",
    "tangent",
    "loose_four_bar",
];

impl Example {
    /// The example of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        EXAMPLES.iter().find(|example| example.name == name)
    }

    /// The linkage, read.
    ///
    /// # Errors
    /// None that the tests have let through.
    pub fn linkage(&self) -> Result<DrivenLinkage, FileError> {
        DrivenLinkage::parse(&format!("example {}", self.name), self.text)
    }

    /// What the file's leading comment says of the linkage, in its first line.
    pub fn summary(&self) -> &'static str {
        let first = self.text.lines().next().unwrap_or_default();
        first.trim_start_matches('#').trim()
    }
}
