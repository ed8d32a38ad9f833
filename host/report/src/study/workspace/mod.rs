//! The study of an arm's workspace in all its branches.
//!
//! The mechanics are in [`fivebar_design::workspace`].

mod answer;

use fivebar_design::workspace::{
    Areas, Grid, GridError, Rectangle, WorkspaceMap, reach_bounds, round_down,
};
use fivebar_files::robot::{Robot, WorkspaceError};
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use nalgebra::Vector2;
use rayon::prelude::*;

/// Least number of cells along the longer side of the reach, by default.
const CELLS: f64 = 160.0;

/// A reach smaller than this share of the base is rounding.
const LEAST_REACH: f64 = 1e-6;

/// Why a workspace cannot be studied.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorkspaceStudyError {
    /// The robot's tool or limits are not valid.
    #[error("robot `{0}`: {1}")]
    Robot(String, WorkspaceError),
    /// The size of the cells is not valid.
    #[error("cells of {pitch:.1e} m: {error}; give another --resolution")]
    Grid {
        /// Side of a cell [m].
        pitch: f64,
        /// The error.
        error: GridError,
    },
    /// No cell is reached.
    #[error(
        "robot `{0}` reaches no position that a map can show: its legs hardly meet, or the cells \
         are too large; check the lengths, or give a finer --resolution"
    )]
    NothingReached(String),
}

/// A working mode with an assembly mode.
#[derive(Clone, Debug)]
pub struct Branch {
    /// The working mode.
    pub mode: WorkingMode,
    /// The assembly mode.
    pub assembly: Side,
    /// Its areas.
    pub areas: Areas,
    /// The largest clear rectangle.
    pub rectangle: Option<Rectangle>,
    /// The clear position with the least condition number κ [m], and 1/κ there.
    pub best: Option<(Vector2<f64>, f64)>,
}

/// The workspace of a robot in all branches.
#[derive(Debug)]
pub struct WorkspaceStudy<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// One map for each of the four working modes.
    pub maps: Vec<WorkspaceMap>,
    /// The eight branches, two for each working mode.
    pub branches: Vec<Branch>,
}

impl<'a> WorkspaceStudy<'a> {
    /// Studies a robot with cells of `resolution` [m]; by default at least 160 cells along the
    /// longer side.
    ///
    /// # Errors
    /// Limits or cells that are not valid, or an arm that reaches no cell.
    pub fn new(robot: &'a Robot, resolution: Option<f64>) -> Result<Self, WorkspaceStudyError> {
        let workspace = |mode| {
            let named = |error| WorkspaceStudyError::Robot(robot.name.clone(), error);
            robot.workspace(mode).map_err(named)
        };
        let tool = workspace(robot.working_mode())?.tool;
        let [low, high] = reach_bounds(&tool);
        let size = (high.x - low.x).max(high.y - low.y);
        let nothing = || WorkspaceStudyError::NothingReached(robot.name.clone());
        if size < LEAST_REACH * tool.geometry().base() {
            return Err(nothing());
        }
        let pitch = resolution.unwrap_or_else(|| round_down(size / CELLS));
        let grid = Grid::over(&tool, pitch);
        let grid = grid.map_err(|error| WorkspaceStudyError::Grid { pitch, error })?;
        let maps = WorkingMode::ALL.into_par_iter();
        let maps: Vec<WorkspaceMap> = maps
            .map(|mode| Ok(WorkspaceMap::new(workspace(mode)?, grid)))
            .collect::<Result<_, _>>()?;
        if maps.iter().all(|map| map.reached().next().is_none()) {
            return Err(nothing());
        }
        let branches = maps
            .iter()
            .flat_map(|map| Side::BOTH.map(|side| (map, side)));
        Ok(Self {
            robot,
            branches: branches.map(|(map, side)| Branch::of(map, side)).collect(),
            maps,
        })
    }

    /// The largest clear rectangle of a working mode, over both assembly modes.
    pub fn largest_rectangle(&self, mode: WorkingMode) -> Option<Rectangle> {
        let branches = self.branches.iter().filter(|branch| branch.mode == mode);
        let rectangles = branches.filter_map(|branch| branch.rectangle);
        rectangles.max_by(|a, b| a.area().total_cmp(&b.area()))
    }
}

impl Branch {
    fn of(map: &WorkspaceMap, assembly: Side) -> Self {
        let best = map.best_conditioned(assembly);
        Self {
            mode: map.workspace().mode,
            assembly,
            areas: map.areas(assembly),
            rectangle: map.largest_rectangle(assembly),
            best: best.map(|(place, cell)| (place, cell.inverse_condition)),
        }
    }
}

#[cfg(test)]
mod tests {
    use fivebar_design::workspace::round_down;

    #[test]
    fn cells_have_round_sizes() {
        for (value, expected) in [
            (4.3e-3, 2e-3),
            (5.1e-3, 5e-3),
            (1.3e-3, 1e-3),
            (0.021, 0.02),
        ] {
            let found = round_down(value);
            assert!(
                (found / expected - 1.0).abs() < 1e-12,
                "{found} for {value}"
            );
        }
    }
}
