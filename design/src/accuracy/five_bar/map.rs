//! The accuracy over the workspace: scatter and worst cases in every cell of a grid, and the
//! cheapest tolerances that keep the scatter within a bound.

use super::analysis::{AccuracyAnalysis, TolerancedArm, ToolState, analyse};
use crate::accuracy::allocation::{Allocation, ToleranceClass, allocate};
use core::fmt;
use fivebar_kinematics::five_bar::Geometry;
use nalgebra::Vector2;
use rayon::prelude::*;

/// Cells along the longer side of the grid.
const CELLS: usize = 64;

/// One cell of the grid.
#[derive(Clone, Debug)]
pub struct AccuracyCell {
    /// C [m].
    pub position: [f64; 2],
    /// The analysis there; none out of reach or within the singularity margin.
    pub analysis: Option<AccuracyAnalysis>,
}

/// A grid over the reach of an arm.
#[derive(Clone, Debug)]
pub struct AccuracyMap {
    /// Distance between cells [m].
    pub pitch: f64,
    /// Cells in a row.
    pub columns: usize,
    /// Row by row from the lower left.
    pub cells: Vec<AccuracyCell>,
}

impl AccuracyMap {
    /// The analyses of all cells that have one.
    pub fn reached(&self) -> impl Iterator<Item = &AccuracyAnalysis> {
        self.cells.iter().filter_map(|cell| cell.analysis.as_ref())
    }
}

/// Why there is no map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MapError {
    /// The region has no area.
    EmptyRegion,
    /// The region has no position that can be analysed.
    NothingReached,
}

impl fmt::Display for MapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::EmptyRegion => "the region is empty",
            Self::NothingReached => "no position of the region can be analysed",
        })
    }
}

impl core::error::Error for MapError {}

/// Maps the accuracy of an arm at rest under a force on C [N], over its reach or over `region`,
/// which is [x0, y0, x1, y1] [m]. Positions nearer to a singularity than `singularity_margin`,
/// in the measure of [`Pose::nearest_singularity`](fivebar_kinematics::five_bar::Pose), are
/// left out.
///
/// # Errors
/// `EmptyRegion`, or `NothingReached` if no cell of the region can be analysed.
pub fn accuracy_map(
    arm: &TolerancedArm<'_>,
    singularity_margin: f64,
    force: Vector2<f64>,
    region: Option<[f64; 4]>,
) -> Result<AccuracyMap, MapError> {
    let [x0, y0, x1, y1] = region.unwrap_or_else(|| reach(arm.geometry));
    let pitch = (x1 - x0).max(y1 - y0) / (CELLS - 1) as f64;
    if !(pitch > 0.0 && pitch.is_finite()) {
        return Err(MapError::EmptyRegion);
    }
    let count = |from: f64, to: f64| ((to - from) / pitch).round().max(0.0) as usize + 1;
    let (columns, rows) = (count(x0, x1), count(y0, y1));
    let cell = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let position = Vector2::new(x0 + pitch * column as f64, y0 + pitch * row as f64);
        let state = ToolState {
            force,
            ..ToolState::at_rest(position)
        };
        let clear = |analysis: &AccuracyAnalysis| {
            analysis.pose.nearest_singularity().1 >= singularity_margin
        };
        AccuracyCell {
            position: [position.x, position.y],
            analysis: analyse(arm, &state).ok().filter(clear),
        }
    };
    let cells: Vec<AccuracyCell> = (0..columns * rows).into_par_iter().map(cell).collect();
    let map = AccuracyMap {
        pitch,
        columns,
        cells,
    };
    if map.reached().next().is_none() {
        return Err(MapError::NothingReached);
    }
    Ok(map)
}

/// The box around the reach of both legs.
fn reach(geometry: &Geometry<f64>) -> [f64; 4] {
    let [_, outer1] = geometry.leg1_radii();
    let [_, outer4] = geometry.leg4_radii();
    let base = geometry.base();
    let height = outer1.min(outer4);
    [
        (-outer1).max(base - outer4),
        -height,
        outer1.min(base + outer4),
        height,
    ]
}

/// The cheapest classes for θ1, θ4, l1…l4 and the base that keep √(σx² + σy²) within `bound`
/// [m] in all cells of a map; none if no choice does. `inputs` are the classes of the two
/// angles [rad], `lengths` those of the five lengths [m].
pub fn cheapest_classes(
    map: &AccuracyMap,
    bound: f64,
    inputs: &[ToleranceClass],
    lengths: &[ToleranceClass],
) -> Option<Allocation> {
    let weights: Vec<Vec<f64>> = map.reached().map(AccuracyAnalysis::weights).collect();
    let classes: Vec<Vec<ToleranceClass>> = (0..7)
        .map(|i| {
            if i < 2 {
                inputs.to_vec()
            } else {
                lengths.to_vec()
            }
        })
        .collect();
    allocate(&weights, &classes, bound * bound)
}
