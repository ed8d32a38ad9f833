//! Mechanisms for the analysis of mobility: read from TOML or JSON.

mod cases;
mod mechanism_file;

use crate::source::{FileError, Source};
use crate::text_file;
use fivebar_design::mobility::{MechanismGraph, ParallelMechanism};
use std::path::Path;

/// Greatest size of a file [bytes]: a mechanism within the limits needs far less.
const LARGEST_FILE: u64 = 4 << 20;

/// A mechanism to analyse, with its name.
pub struct MobilityCase {
    /// Its name.
    pub name: String,
    /// A sentence about it; may be empty.
    pub description: String,
    /// The mechanism.
    pub mechanism: Mechanism,
}

/// A mechanism in one of two descriptions.
pub enum Mechanism {
    /// A platform on limbs.
    Parallel(ParallelMechanism),
    /// Any graph of bodies and joints.
    Graph(MechanismGraph),
}

/// Reads the mechanisms of a file: TOML with one mechanism, or JSON with lists of cases.
///
/// # Errors
/// The file, the line or case, and the reason.
pub fn read(path: &Path) -> Result<Vec<MobilityCase>, FileError> {
    let shown = path.display();
    let text =
        text_file::read_text(path, LARGEST_FILE).map_err(|error| FileError::new(&shown, error))?;
    parse(&shown.to_string(), &text)
}

/// The mechanisms in the text of a file called `file`: cases in JSON if its name ends in
/// `.json`, else one mechanism in TOML.
///
/// # Errors
/// The file, the line or case, and the reason.
pub fn parse(file: &str, text: &str) -> Result<Vec<MobilityCase>, FileError> {
    if Path::new(file).extension().is_some_and(|e| e == "json") {
        cases::parse(text).map_err(|reason| FileError::new(file, reason))
    } else {
        mechanism_file::parse(&Source::new(file, text)).map(|study| vec![study])
    }
}

/// The built-in examples: name and text.
pub const EXAMPLES: [(&str, &str); 9] = [
    ("five-bar", include_str!("../../mobility/five-bar.toml")),
    (
        "five-bar-elbows-meet",
        include_str!("../../mobility/five-bar-elbows-meet.toml"),
    ),
    (
        "five-bar-flat",
        include_str!("../../mobility/five-bar-flat.toml"),
    ),
    ("huang-3rrr", include_str!("../../mobility/huang-3rrr.toml")),
    (
        "huang-4rprrr",
        include_str!("../../mobility/huang-4rprrr.toml"),
    ),
    ("four-bar", include_str!("../../mobility/four-bar.toml")),
    ("delta", include_str!("../../mobility/delta.toml")),
    ("stewart", include_str!("../../mobility/stewart.toml")),
    (
        "slider-parallelograms",
        include_str!("../../mobility/slider-parallelograms.toml"),
    ),
];
