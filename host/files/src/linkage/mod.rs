//! Linkages and their drives: read from TOML and checked once.

mod build;
mod builtin;
mod file;
mod limits;
mod names;
mod tolerance;

pub use builtin::{EXAMPLES, Example};
pub use names::{driven_links, dyads, links_of, reaction_names};

use crate::did_you_mean;
use crate::source::{FileError, Source};
use crate::text_file;
use fivebar_design::accuracy::linkage::{LinkageTolerance, TolerancedLinkage};
use fivebar_design::linkage::{DriveLaw, Linkage, Sweep};
use std::io::ErrorKind;

/// A linkage with the motion of its driven links.
#[derive(Clone, Debug, PartialEq)]
pub struct DrivenLinkage {
    /// Its name.
    pub name: String,
    /// The linkage.
    pub linkage: Linkage<f64>,
    /// The law of motion of each driven link.
    pub laws: Vec<DriveLaw>,
    /// Duration of the sweep [s].
    pub duration: f64,
    /// Number of its steps.
    pub steps: usize,
    /// The tolerances of its parts.
    pub tolerance: LinkageTolerance,
}

impl DrivenLinkage {
    /// Computes the motion that its file describes.
    pub fn sweep(&self) -> Sweep {
        Sweep::new(&self.linkage, &self.laws, self.duration, self.steps)
    }

    /// The linkage with this name on the command line: a built-in example, or else a file.
    ///
    /// # Errors
    /// A file that cannot be read, or that [`DrivenLinkage::parse`] refuses.
    pub fn load(name_or_path: &str) -> Result<Self, FileError> {
        if let Some(example) = Example::find(name_or_path) {
            return example.linkage();
        }
        let read = text_file::read_text(name_or_path.as_ref(), text_file::LARGEST_TOML);
        let text = read.map_err(|error| {
            let reason = match error.kind() {
                ErrorKind::FileTooLarge => error.to_string(),
                ErrorKind::InvalidData => format!("cannot be read as text: {error}"),
                _ => {
                    let known = EXAMPLES.iter().map(|example| example.name);
                    let near = did_you_mean(name_or_path, known);
                    format!("neither a built-in example nor a file: {error}{near}")
                }
            };
            FileError::new(name_or_path, reason)
        })?;
        Self::parse(name_or_path, &text)
    }

    /// The linkage with its motion and tolerances, for the analysis of its accuracy.
    pub fn toleranced(&self) -> TolerancedLinkage<'_> {
        TolerancedLinkage {
            linkage: &self.linkage,
            laws: &self.laws,
            tolerance: &self.tolerance,
        }
    }

    /// Whether this names a linkage: an example, or a file with a `[sweep]`. False for a file
    /// that cannot be read.
    pub fn is_named(name_or_path: &str) -> bool {
        let has_sweep = |text: String| {
            let table = text.parse::<toml::Table>();
            table.is_ok_and(|table| table.contains_key("sweep"))
        };
        Example::find(name_or_path).is_some()
            || text_file::read_text(name_or_path.as_ref(), text_file::LARGEST_TOML)
                .is_ok_and(has_sweep)
    }

    /// The linkage from the text of a file called `file`.
    ///
    /// # Errors
    /// An unknown or missing key, a name that is not defined yet, or a number that is not
    /// valid, with its line.
    pub fn parse(file: &str, text: &str) -> Result<Self, FileError> {
        build::linkage(&Source::new(file, text))
    }
}
