//! Over the workspace: the scatter and the worst cases at every place of a grid, and the
//! cheapest tolerances that hold a wanted scatter there.

use super::state::{Analysis, State, analyse};
use crate::input::robot::Robot;
use fivebar_design::accuracy::allocation::{Allocation, ToleranceClass, allocate};
use nalgebra::Vector2;
use rayon::prelude::*;

/// Places along the longer side of the grid.
const PLACES: usize = 64;

/// One place of the grid.
#[derive(Clone, Debug)]
pub struct Cell {
    /// C [m].
    pub position: [f64; 2],
    /// What is there; none out of reach or nearer to a singularity than the robot's margin.
    pub analysis: Option<Analysis>,
}

/// A grid over the reach of an arm.
#[derive(Clone, Debug)]
pub struct Map {
    /// Distance between places [m].
    pub pitch: f64,
    /// Places in a row.
    pub columns: usize,
    /// Row by row from the lower left.
    pub cells: Vec<Cell>,
}

impl Map {
    /// The places that the arm can take, with what is there.
    pub fn reached(&self) -> impl Iterator<Item = &Analysis> {
        self.cells.iter().filter_map(|cell| cell.analysis.as_ref())
    }
}

/// Maps a robot at rest under a force on its tool [N], over its reach or within `region`
/// [x0, y0, x1, y1] of it [m].
///
/// # Errors
/// A sentence where nothing of the region can be reached.
pub fn map(robot: &Robot, force: Vector2<f64>, region: Option<[f64; 4]>) -> Result<Map, String> {
    let [x0, y0, x1, y1] = region.unwrap_or_else(|| reach(robot));
    let pitch = (x1 - x0).max(y1 - y0) / (PLACES - 1) as f64;
    if !(pitch > 0.0 && pitch.is_finite()) {
        return Err("the region is empty: give X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1".into());
    }
    let count = |from: f64, to: f64| ((to - from) / pitch).round().max(0.0) as usize + 1;
    let (columns, rows) = (count(x0, x1), count(y0, y1));
    let cell = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let position = Vector2::new(x0 + pitch * column as f64, y0 + pitch * row as f64);
        let state = State {
            position,
            velocity: Vector2::zeros(),
            acceleration: Vector2::zeros(),
            force,
        };
        let clear = |analysis: &Analysis| {
            analysis.pose.nearest_singularity().1 >= robot.limits.singularity_margin
        };
        Cell {
            position: [position.x, position.y],
            analysis: analyse(robot, &state).ok().filter(clear),
        }
    };
    let cells: Vec<Cell> = (0..columns * rows).into_par_iter().map(cell).collect();
    let map = Map {
        pitch,
        columns,
        cells,
    };
    if map.reached().next().is_none() {
        return Err("no place of the region can be reached clear of singularities".into());
    }
    Ok(map)
}

/// The box around both legs' reach.
fn reach(robot: &Robot) -> [f64; 4] {
    let geometry = &robot.geometry;
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

/// The cheapest classes for θ1, θ4, l1…l4 and the base that keep √(σx² + σy²) within
/// `wanted` [m] all over a map; `inputs` are the classes of the two angles [rad], `lengths`
/// those of the five lengths [m].
pub fn cheapest(
    map: &Map,
    wanted: f64,
    inputs: &[ToleranceClass],
    lengths: &[ToleranceClass],
) -> Option<Allocation> {
    let weights: Vec<Vec<f64>> = map.reached().map(Analysis::weights).collect();
    let classes: Vec<Vec<ToleranceClass>> = (0..7)
        .map(|i| {
            if i < 2 {
                inputs.to_vec()
            } else {
                lengths.to_vec()
            }
        })
        .collect();
    allocate(&weights, &classes, wanted * wanted)
}
