//! Mechanisms whose mobility is asked for: read from TOML or JSON.

mod cases;
mod described;

use crate::input::source::Source;
use fivebar_design::mobility::{MechanismGraph, ParallelMechanism};
use std::path::Path;

/// The largest file that is read: a mechanism within the limits needs far less.
const LARGEST_FILE: u64 = 4 << 20;

/// A mechanism to analyse, under its name.
pub struct Study {
    /// What it is called.
    pub name: String,
    /// What it is, in a sentence; may be empty.
    pub description: String,
    /// How it is built.
    pub mechanism: Mechanism,
}

/// The two ways of describing a mechanism.
pub enum Mechanism {
    /// A platform on limbs.
    Parallel(ParallelMechanism),
    /// Any graph of bodies and joints.
    Graph(MechanismGraph),
}

/// The studies in a file: TOML with one mechanism, or JSON with lists of cases.
///
/// # Errors
/// A sentence naming the file, the place and what is wrong.
pub fn read(path: &Path) -> Result<Vec<Study>, String> {
    let shown = path.display();
    let size = std::fs::metadata(path)
        .map_err(|error| format!("{shown}: {error}"))?
        .len();
    if size > LARGEST_FILE {
        return Err(format!(
            "{shown}: {size} bytes, more than any mechanism within the limits needs ({LARGEST_FILE})"
        ));
    }
    let text = std::fs::read_to_string(path).map_err(|error| format!("{shown}: {error}"))?;
    parse(&shown.to_string(), &text)
}

/// The studies in the text of a file called `file`: cases in JSON if its name ends so, else
/// a mechanism in TOML.
///
/// # Errors
/// A sentence naming the file, the place and what is wrong.
pub fn parse(file: &str, text: &str) -> Result<Vec<Study>, String> {
    if Path::new(file).extension().is_some_and(|e| e == "json") {
        cases::parse(text).map_err(|reason| format!("{file}: {reason}"))
    } else {
        described::parse(Source { file, text })
            .map(|study| vec![study])
            .map_err(|error| error.to_string())
    }
}

/// The examples that come with the program, by name.
pub const EXAMPLES: [(&str, &str); 9] = [
    ("five-bar", include_str!("../../../mobility/five-bar.toml")),
    (
        "five-bar-elbows-meet",
        include_str!("../../../mobility/five-bar-elbows-meet.toml"),
    ),
    (
        "five-bar-flat",
        include_str!("../../../mobility/five-bar-flat.toml"),
    ),
    (
        "huang-3rrr",
        include_str!("../../../mobility/huang-3rrr.toml"),
    ),
    (
        "huang-4rprrr",
        include_str!("../../../mobility/huang-4rprrr.toml"),
    ),
    ("four-bar", include_str!("../../../mobility/four-bar.toml")),
    ("delta", include_str!("../../../mobility/delta.toml")),
    ("stewart", include_str!("../../../mobility/stewart.toml")),
    (
        "slider-parallelograms",
        include_str!("../../../mobility/slider-parallelograms.toml"),
    ),
];
