//! Bounds on what a file may ask for, so that no file takes more time or memory than any
//! use deserves.

use super::file::LinkageFile;
use crate::input::source::{FileError, Key, Source};
use fivebar_design::linkage::Linkage;

/// A hundred elements are more than any planar linkage in use has.
const MOST_ELEMENTS: usize = 100;
const MOST_POINTS: usize = 1_000;
/// Samples times elements that a sweep may keep: some hundred megabytes.
const MOST_SOLUTIONS: usize = 200_000;
/// Assemblies double with each dyad that has two branches.
const MOST_BRANCHES: usize = 10;
/// Numbers beyond this, in SI units, are slips; their squares would still be finite.
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
            "has {branches} dyads with two branches each; more than {MOST_BRANCHES} have too \
             many assemblies to go through"
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

/// Refuses numbers that are surely slips.
pub(super) fn largest(source: &Source<'_>, linkage: &Linkage<f64>) -> Result<(), FileError> {
    let mut too_large = None;
    linkage.map_parameters(|parameter, value: f64| {
        if value.abs() > LARGEST && too_large.is_none() {
            too_large = Some(format!("a number of `{}`, {value:?},", parameter.part));
        }
        value
    });
    too_large.map_or(Ok(()), |what| {
        let reason = format!("{what} is beyond {LARGEST:e} in SI units: surely a slip");
        Err(FileError {
            file: source.file.into(),
            line: None,
            reason,
        })
    })
}

/// Refuses names that a table could not show.
pub(super) fn name(source: &Source<'_>, key: Key, name: &str) -> Result<(), FileError> {
    let sound = !name.trim().is_empty()
        && name.chars().count() <= LONGEST_NAME
        && !name.chars().any(char::is_control);
    if sound {
        Ok(())
    } else {
        let reason = format!("must be a name of 1 to {LONGEST_NAME} characters in one line");
        Err(source.refuse(key, reason))
    }
}
