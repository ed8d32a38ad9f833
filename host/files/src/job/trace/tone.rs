//! Hatching by tone: parallel lines at 45°, a pen's width apart, of which the more are drawn the darker the picture is.
//!
//! Of 16 lines in sequence, each is drawn where the picture is darker than its own threshold. The thresholds are spread evenly,
//! so the share of paper with ink is that of darkness within 1/32. Neighbouring lines have thresholds far apart (the bits of the
//! line's number in reverse), so that those of one tone lie evenly.

use super::Stroke;
use super::raster::Raster;
use crate::budget::{Budget, OverBudget};
use std::f64::consts::FRAC_1_SQRT_2;

/// Thresholds in sequence.
const THRESHOLDS: u32 = 16;
/// Distance of the places at which a line looks at the picture, in widths of the pen, and at least [pixels].
const STEP: f64 = 0.5;
/// Shorter lines, and shorter gaps between two, are left out, in widths of the pen.
const SHORTEST: f64 = 1.0;

/// The lines.
pub(super) fn lines(raster: &Raster, pen: f64) -> Result<Vec<Stroke>, OverBudget> {
    let [width, height] = [raster.width(), raster.height()].map(|it| it as f64);
    let mut budget = Budget::dots();
    let mut strokes = Vec::new();
    // x = (u − v)/√2, y = (u + v)/√2
    let first = (-FRAC_1_SQRT_2 * width / pen).ceil();
    let end = (FRAC_1_SQRT_2 * height / pen).ceil();
    budget.take_calculated(end - first)?;
    for number in first as i64..end as i64 {
        let v = number as f64 * pen;
        let place = |u: f64| [FRAC_1_SQRT_2 * (u - v), FRAC_1_SQRT_2 * (u + v)];
        let threshold = threshold(number);
        // Within the picture 0 ≤ x ≤ width and 0 ≤ y ≤ height.
        let from = v.abs();
        let to = (width / FRAC_1_SQRT_2 + v).min(height / FRAC_1_SQRT_2 - v);
        let count = ((to - from) / (STEP * pen).max(STEP)).ceil().max(0.0) as usize;
        let step = (to - from) / count as f64;
        let is_dark = |index: usize| {
            let u = from + (index as f64 + 0.5) * step;
            raster.between(place(u)) > threshold
        };
        let shortest = (SHORTEST * pen / step).ceil() as usize;
        let runs = runs((0..count).map(is_dark), shortest);
        budget.take(runs.len())?;
        strokes.extend(runs.into_iter().map(|[first, end]| {
            [first, end]
                .map(|at| place(from + at as f64 * step))
                .to_vec()
        }));
    }
    Ok(strokes)
}

/// The darkness from which on a line is drawn.
fn threshold(number: i64) -> f64 {
    let place = number.rem_euclid(i64::from(THRESHOLDS)) as u32;
    let reversed = place.reverse_bits() >> (THRESHOLDS.leading_zeros() + 1);
    (f64::from(reversed) + 0.5) / f64::from(THRESHOLDS)
}

/// The runs of dark places, from the first to behind the last one, without gaps and runs that are shorter than `shortest`.
fn runs(places: impl Iterator<Item = bool>, shortest: usize) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for (at, _) in places.enumerate().filter(|(_, is_dark)| *is_dark) {
        match runs.last_mut() {
            Some([_, end]) if at - *end < shortest => *end = at + 1,
            _ => runs.push([at, at + 1]),
        }
    }
    runs.retain(|[first, end]| end - first >= shortest);
    runs
}
