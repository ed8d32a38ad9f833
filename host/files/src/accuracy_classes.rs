//! Classes of tolerance: the standard deviation of a dimension, and its cost.

use super::source::{FileError, Source};
use super::text_file;
use fivebar_design::accuracy::allocation::ToleranceClass;
use serde::Deserialize;
use std::path::Path;

/// `[[input]]` and `[[length]]` tables with `name`, `sd` and `cost`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Classes {
    input: Vec<ClassEntry>,
    length: Vec<ClassEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ClassEntry {
    name: String,
    /// [rad] or [m].
    sd: f64,
    cost: f64,
}

impl Classes {
    /// Reads a file of classes.
    ///
    /// # Errors
    /// The file with the reason why it cannot be read or is not valid.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let shown = path.display();
        let refuse = |reason: String| FileError::new(&shown, reason);
        let text = text_file::read_text(path, text_file::LARGEST_TOML)
            .map_err(|error| FileError::new(&shown, error))?;
        let name = shown.to_string();
        let source = Source::new(&name, &text);
        let classes: Self = source.parse()?;
        let is_valid = |entry: &ClassEntry| {
            entry.sd >= 0.0 && entry.sd.is_finite() && entry.cost >= 0.0 && entry.cost.is_finite()
        };
        if classes.input.is_empty() || classes.length.is_empty() {
            return Err(refuse(
                "give at least one [[input]] and one [[length]]".into(),
            ));
        }
        match classes
            .input
            .iter()
            .chain(&classes.length)
            .find(|entry| !is_valid(entry))
        {
            Some(entry) => Err(refuse(format!(
                "class {:?}: sd and cost must be finite and not negative",
                entry.name
            ))),
            None => Ok(classes),
        }
    }

    /// The classes of the driven angles.
    pub fn inputs(&self) -> Vec<ToleranceClass> {
        self.input.iter().map(ClassEntry::class).collect()
    }

    /// The classes of the lengths.
    pub fn lengths(&self) -> Vec<ToleranceClass> {
        self.length.iter().map(ClassEntry::class).collect()
    }

    /// Each dimension with the name of its class.
    ///
    /// # Panics
    /// If the choice is not one of
    /// [`cheapest_classes`](fivebar_design::accuracy::five_bar::cheapest_classes) from these
    /// classes.
    pub fn names(&self, choice: &[usize]) -> Vec<(&'static str, String)> {
        let dimensions = ["θ1", "θ4", "l1", "l2", "l3", "l4", "base"];
        let name = |(dimension, (index, &class)): (&'static str, (usize, &usize))| {
            let list = if index < 2 { &self.input } else { &self.length };
            (dimension, list[class].name.clone())
        };
        dimensions
            .into_iter()
            .zip(choice.iter().enumerate())
            .map(name)
            .collect()
    }
}

impl ClassEntry {
    fn class(&self) -> ToleranceClass {
        ToleranceClass {
            deviation: self.sd,
            cost: self.cost,
        }
    }
}
