//! The built-in example linkages.

use super::DrivenLinkage;
use crate::source::FileError;

/// A linkage file that is part of the program.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// Its name on the command line.
    pub name: &'static str,
    /// The text of its file.
    pub text: &'static str,
}

macro_rules! examples {
    ($($name:literal),* $(,)?) => {
        &[$(Example {
            name: $name,
            text: include_str!(concat!("../../linkages/", $name, ".toml")),
        }),*]
    };
}

/// All examples.
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
    /// The example with this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        EXAMPLES.iter().find(|example| example.name == name)
    }

    /// Reads the linkage.
    ///
    /// # Errors
    /// None: tests read every example.
    pub fn linkage(&self) -> Result<DrivenLinkage, FileError> {
        DrivenLinkage::parse(&format!("example {}", self.name), self.text)
    }

    /// A summary of the linkage: the first line of its file's leading comment.
    pub fn summary(&self) -> &'static str {
        let first = self.text.lines().next().unwrap_or_default();
        first.trim_start_matches('#').trim()
    }
}
