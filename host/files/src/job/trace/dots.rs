//! Dots whose number follows the tone: on a grid, each cell has one or none, and what a cell has too little or too much of goes to
//! its neighbours (R. Floyd and L. Steinberg, 1976).

use super::Stroke;
use super::raster::Raster;
use crate::budget::{Budget, OverBudget};
use std::f64::consts::FRAC_PI_4;

/// Length of a dot's stroke, in widths of the pen: it is drawn as a short line.
const DOT: f64 = 0.1;
/// A short path through n dots that keep their distance on an area A is about this times √(n A): measured here. It is 1 on a
/// square grid, and 0.71 for dots that lie anywhere (J. Beardwood, J. Halton and J. Hammersley, 1959).
const TOUR: f64 = 0.96;

/// Dots, each as a short stroke: their number times the area of a dot is the ink that the tone asks for.
pub(super) fn stipple(raster: &Raster, pen: f64) -> Result<Vec<Stroke>, OverBudget> {
    let side = FRAC_PI_4.sqrt() * pen;
    let half = 0.5 * DOT * pen;
    let dots = spread(raster, side, |dark| dark)?;
    let strokes = dots
        .into_iter()
        .map(|[x, y]| vec![[x - half, y], [x + half, y]]);
    Ok(strokes.collect())
}

/// The dots through which one line goes: by [`TOUR`], their density is the square of the tone.
pub(super) fn for_one_line(raster: &Raster, pen: f64) -> Result<Vec<[f64; 2]>, OverBudget> {
    spread(raster, pen, |dark| (dark / TOUR).powi(2).min(1.0))
}

/// Dots on a grid of cells; `wanted` gives the dots of a cell by its darkness.
fn spread(
    raster: &Raster,
    side: f64,
    wanted: impl Fn(f64) -> f64,
) -> Result<Vec<[f64; 2]>, OverBudget> {
    let [columns, rows] = [raster.width(), raster.height()].map(|it| (it as f64 / side).ceil());
    let mut budget = Budget::dots();
    Budget::cells().take_calculated(columns * rows)?;
    let [columns, rows] = [columns as usize, rows as usize];
    let mut dots = Vec::new();
    // What the row and the one below still want, with a cell at each end that is not drawn.
    let (mut here, mut below) = (vec![0.0; columns + 2], vec![0.0; columns + 2]);
    for row in 0..rows {
        let is_back = row % 2 == 1;
        for index in 0..columns {
            let column = if is_back { columns - 1 - index } else { index };
            let corner = [column as f64 * side, row as f64 * side];
            let want: f64 = here[column + 1] + wanted(raster.mean(corner, side));
            let has_dot = want > 0.5 + 0.2 * (noise(column, row) - 0.5);
            let rest = want - f64::from(u8::from(has_dot));
            if has_dot {
                budget.take(1)?;
                dots.push(corner.map(|at| at + 0.5 * side));
            }
            let [ahead, behind] = if is_back {
                [column, column + 2]
            } else {
                [column + 2, column]
            };
            here[ahead] += 7.0 / 16.0 * rest;
            below[behind] += 3.0 / 16.0 * rest;
            below[column + 1] += 5.0 / 16.0 * rest;
            below[ahead] += 1.0 / 16.0 * rest;
        }
        std::mem::swap(&mut here, &mut below);
        below.fill(0.0);
    }
    Ok(dots)
}

/// A number from 0 to 1 that differs from cell to cell and breaks up patterns.
fn noise(column: usize, row: usize) -> f64 {
    let mixed = (column as u32).wrapping_mul(0x9E37_79B1) ^ (row as u32).wrapping_mul(0x85EB_CA6B);
    let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D);
    f64::from(mixed >> 8) / f64::from(1 << 24)
}
