//! Checks of single values of a robot file.

use crate::refusal::{Key, Refusal};
use std::ops::RangeInclusive;

/// Greatest and least length of a link or the base [m]. Greater numbers are probably in
/// millimetres.
pub(super) const LONGEST: f64 = 20.0;
pub(super) const SHORTEST: f64 = 1e-6;

/// The least mass [kg] and moment of inertia [kg·m²] of a link: a milligram, and a rod of it 1 mm
/// long.
pub(super) const LEAST_MASS: (f64, &str) = (1e-6, "kg");
pub(super) const LEAST_INERTIA: (f64, &str) = (1e-13, "kg·m²");

/// The least limits of motion. With these, a move of 10 mm takes two minutes.
pub(super) const LEAST_SPEED: f64 = 1e-4;
pub(super) const LEAST_ACCELERATION: f64 = 1e-4;
pub(super) const LEAST_JERK: f64 = 1e-4;

/// Least and greatest size of a value: a little less than the range of single precision.
const SIZES: RangeInclusive<f64> = 1e-30..=1e30;

pub(super) const POSITIVE: &str = "must be a positive finite number";
pub(super) const NOT_NEGATIVE: &str = "must be finite and not negative";
const FINITE: &str = "must be finite, 1e30 at most";
const SIZED: &str = "must be 1e-30 to 1e30 in size";

pub(super) fn positive(key: Key, value: f64) -> Result<(), Refusal> {
    if value > 0.0 && value.is_finite() {
        sized(key, value)
    } else {
        Err(key.refused(format!("{POSITIVE}, not {value:?}")))
    }
}

/// A value that is not too small to be meant in this unit. Runs of smaller ones take hours.
pub(super) fn at_least(key: Key, value: f64, (least, unit): (f64, &str)) -> Result<(), Refusal> {
    positive(key, value)?;
    if value >= least {
        Ok(())
    } else {
        let reason = format!("must be at least {least:e} {unit}, not {value:?}");
        Err(key.refused(reason))
    }
}

pub(super) fn not_negative(key: Key, value: f64) -> Result<(), Refusal> {
    if value == 0.0 {
        Ok(())
    } else if value > 0.0 && value.is_finite() {
        sized(key, value)
    } else {
        Err(key.refused(format!("{NOT_NEGATIVE}, not {value:?}")))
    }
}

pub(super) fn sized(key: Key, value: f64) -> Result<(), Refusal> {
    if SIZES.contains(&value.abs()) {
        Ok(())
    } else {
        Err(key.refused(format!("{SIZED}, not {value:?}")))
    }
}

pub(super) fn finite(key: Key, value: [f64; 2]) -> Result<(), Refusal> {
    let [x, y] = value;
    let greatest = *SIZES.end();
    if x.abs() <= greatest && y.abs() <= greatest {
        Ok(())
    } else {
        Err(key.refused(format!("{FINITE}, not [{x:?}, {y:?}]")))
    }
}

/// A point of a link [m]. Numbers that are probably in millimetres are refused.
pub(super) fn near(key: Key, value: [f64; 2]) -> Result<(), Refusal> {
    finite(key, value)?;
    if value.iter().all(|metres| metres.abs() <= LONGEST) {
        Ok(())
    } else {
        let reason = format!("is in metres, {LONGEST:?} at most, not {value:?}");
        Err(key.refused(reason))
    }
}

pub(super) fn increasing(key: Key, [least, greatest]: [f64; 2]) -> Result<(), Refusal> {
    if least < greatest && least.is_finite() && greatest.is_finite() {
        Ok(())
    } else {
        let reason = format!("must be [least, greatest], not [{least:?}, {greatest:?}]");
        Err(key.refused(reason))
    }
}

/// A number with three significant digits, for messages.
pub(super) fn rounded(value: f64) -> String {
    let value = format!("{value:.2e}").parse().unwrap_or(value);
    if value == 0.0 || (1e-3..1e5).contains(&value) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// In single precision, as the controller has it.
pub(super) fn single(value: f64) -> f32 {
    value as f32
}
