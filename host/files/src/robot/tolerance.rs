//! `[tolerance]`: reads one number for all, or one for each.

use super::file::{OneOrEach, ToleranceFile};
use super::value::not_negative;
use crate::source::{FileError, Key, Source};
use fivebar_design::accuracy::five_bar::ArmTolerance;

pub(super) fn read(source: &Source<'_>, file: &ToleranceFile) -> Result<ArmTolerance, FileError> {
    Ok(ArmTolerance {
        length_sd: each(
            source,
            "length_sd",
            &file.length_sd,
            "l1 to l4 and the base",
        )?,
        input_sd: each(source, "input_sd", &file.input_sd, "θ1 and θ4")?,
        input_max: each(source, "input_max", &file.input_max, "θ1 and θ4")?,
        clearance_radius: each(source, "clearance_radius", &file.clearance_radius, "A to E")?,
    })
}

/// One number for all of `whose`, or one for each of them.
pub(super) fn each<const N: usize>(
    source: &Source<'_>,
    name: &'static str,
    given: &OneOrEach,
    whose: &str,
) -> Result<[f64; N], FileError> {
    let key = Key::In("tolerance", name);
    let values = match given {
        OneOrEach::One(value) => [*value; N],
        OneOrEach::Each(values) => values.as_slice().try_into().map_err(|_| {
            let reason = format!(
                "must be one number or {N}, for {whose}, not {}",
                values.len()
            );
            source.refuse(key, reason)
        })?,
    };
    for value in values {
        not_negative(source, key, value)?;
    }
    Ok(values)
}
