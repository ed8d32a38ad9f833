//! Limits on the size of a linkage file, so that no file takes unreasonable time or memory.

use super::file::LinkageFile;
use crate::refusal::Key;
use crate::source::{FileError, Source};
use fivebar_design::linkage::Linkage;

/// Most elements; more than any planar linkage in use has.
const MOST_ELEMENTS: usize = 100;
const MOST_POINTS: usize = 1_000;
/// Most samples times elements of a sweep: some hundred megabytes.
const MOST_SOLUTIONS: usize = 200_000;
/// Most dyads with two branches; each of them doubles the number of assemblies.
const MOST_BRANCHES: usize = 10;
/// Greatest number in SI units. Greater ones are probably mistakes; squares of this one are
/// still finite.
pub(super) const LARGEST: f64 = 1e9;
const LONGEST_NAME: usize = 60;

/// Refuses sizes and times out of bounds.
pub(super) fn sizes(source: &Source<'_>, file: &LinkageFile) -> Result<(), FileError> {
    name(source, Key::Top("name"), &file.name)?;
    let elements = file.element.len();
    if elements == 0 || elements > MOST_ELEMENTS {
        let reason = format!("must be given 1 to {MOST_ELEMENTS} times, not {elements}");
        return Err(source.refuse(Key::Top("element"), reason));
    }
    let branches = file.element.iter().filter(|e| e.has_branch()).count();
    if branches > MOST_BRANCHES {
        let reason = format!(
            "has {branches} dyads with two branches each; with more than {MOST_BRANCHES} there are \
             too many assemblies to compute"
        );
        return Err(source.refuse(Key::Top("element"), reason));
    }
    let points = file.point.len() + file.ground.len() + file.load.len();
    if points > MOST_POINTS {
        let reason = format!("and [ground] give {points} points, more than {MOST_POINTS}");
        return Err(source.refuse(Key::Top("point"), reason));
    }
    let duration = file.sweep.duration;
    if !(duration > 0.0 && duration <= LARGEST) {
        let reason = format!("must be a positive number of seconds, not {duration:?}");
        return Err(source.refuse(Key::In("sweep", "duration"), reason));
    }
    let most = MOST_SOLUTIONS / elements;
    let steps = file.sweep.steps;
    if steps == 0 || steps > most {
        let reason = format!("must be 1 to {most} for {elements} elements, not {steps}");
        return Err(source.refuse(Key::In("sweep", "steps"), reason));
    }
    Ok(())
}

/// Refuses numbers that are probably mistakes.
pub(super) fn largest(source: &Source<'_>, linkage: &Linkage<f64>) -> Result<(), FileError> {
    let mut too_large = None;
    linkage.map_parameters(|parameter, value: f64| {
        if value.abs() > LARGEST && too_large.is_none() {
            too_large = Some(format!("a number of `{}`, {value:?},", parameter.part));
        }
        value
    });
    too_large.map_or(Ok(()), |what| {
        let reason = format!("{what} is beyond {LARGEST:e} in SI units: check its unit");
        Err(FileError::new(source.file, reason))
    })
}

/// Refuses names that a table cannot show.
pub(super) fn name(source: &Source<'_>, key: Key, name: &str) -> Result<(), FileError> {
    let is_valid = !name.trim().is_empty()
        && name.chars().count() <= LONGEST_NAME
        && !name.chars().any(char::is_control);
    if is_valid {
        Ok(())
    } else {
        let reason = format!("must be a name of 1 to {LONGEST_NAME} characters in one line");
        Err(source.refuse(key, reason))
    }
}
