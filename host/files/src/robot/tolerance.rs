//! `[tolerance]`: reads one number for all, or one for each.

use super::sections::{OneOrEach, ToleranceFile};
use super::value::not_negative;
use crate::refusal::{Key, Refusal};
use fivebar_design::accuracy::five_bar::ArmTolerance;

pub(super) fn read_tolerance(file: &ToleranceFile) -> Result<ArmTolerance, Refusal> {
    Ok(ArmTolerance {
        length_sd: each("length_sd", &file.length_sd, "l1 to l4 and the base")?,
        input_sd: each("input_sd", &file.input_sd, "θ1 and θ4")?,
        input_max: each("input_max", &file.input_max, "θ1 and θ4")?,
        clearance_radius: each("clearance_radius", &file.clearance_radius, "A to E")?,
    })
}

/// One number for all of `whose`, or one for each of them.
pub(super) fn each<const N: usize>(
    name: &'static str,
    given: &OneOrEach,
    whose: &str,
) -> Result<[f64; N], Refusal> {
    let key = Key::In("tolerance", name);
    let values = match given {
        OneOrEach::One(value) => [*value; N],
        OneOrEach::Each(values) => values.as_slice().try_into().map_err(|_| {
            let reason = format!(
                "must be one number or {N}, for {whose}, not {}",
                values.len()
            );
            key.refused(reason)
        })?,
    };
    for value in values {
        not_negative(key, value)?;
    }
    Ok(values)
}
