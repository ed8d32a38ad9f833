//! Linkages, and how they are driven: read from TOML, checked once.

mod build;
mod builtin;
mod file;
mod limits;
mod names;
mod tolerance;

pub use builtin::{EXAMPLES, Example};
pub(crate) use names::{driven_links, dyads, links_of, reaction_names};
pub use tolerance::{LinkageTolerance, Pin};

use crate::input::source::{FileError, Source};
use fivebar_design::linkage::{DriveLaw, Linkage};
use std::io::Read as _;

/// A linkage and how its file drives it.
#[derive(Clone, Debug, PartialEq)]
pub struct DrivenLinkage {
    /// Its name.
    pub name: String,
    /// What is solved.
    pub linkage: Linkage<f64>,
    /// One law of motion for each driven link.
    pub laws: Vec<DriveLaw>,
    /// How long it is driven [s].
    pub duration: f64,
    /// In how many steps.
    pub steps: usize,
    /// How exact its parts are.
    pub tolerance: LinkageTolerance,
}

/// No sound linkage file comes near this [bytes].
const LARGEST_FILE: u64 = 1 << 20;

impl DrivenLinkage {
    /// The linkage that a command line names: a shipped example, or else a file.
    ///
    /// # Errors
    /// A file that cannot be read, or that [`DrivenLinkage::parse`] refuses.
    pub fn load(name_or_path: &str) -> Result<Self, FileError> {
        if let Some(example) = Example::find(name_or_path) {
            return example.linkage();
        }
        let refuse = |reason| FileError {
            file: name_or_path.into(),
            line: None,
            reason,
        };
        let mut text = String::new();
        let file = std::fs::File::open(name_or_path)
            .map_err(|error| refuse(format!("neither a shipped example nor a file: {error}")))?;
        file.take(LARGEST_FILE + 1)
            .read_to_string(&mut text)
            .map_err(|error| refuse(format!("cannot be read as text: {error}")))?;
        if text.len() as u64 > LARGEST_FILE {
            return Err(refuse(
                "is larger than 1 MiB, which no linkage needs".into(),
            ));
        }
        Self::parse(name_or_path, &text)
    }

    /// Whether a command line names a linkage: an example, or a file with a `[sweep]`. A file
    /// that cannot be read is none.
    pub fn is_named(name_or_path: &str) -> bool {
        let has_sweep = |text: String| {
            let table = text.parse::<toml::Table>();
            table.is_ok_and(|table| table.contains_key("sweep"))
        };
        Example::find(name_or_path).is_some()
            || std::fs::read_to_string(name_or_path).is_ok_and(has_sweep)
    }

    /// The linkage described by the text of a file called `file`.
    ///
    /// # Errors
    /// An unknown or missing key, a name that stands for nothing yet, or a number that
    /// makes no sense, with its line.
    pub fn parse(file: &str, text: &str) -> Result<Self, FileError> {
        build::linkage(Source { file, text })
    }
}
