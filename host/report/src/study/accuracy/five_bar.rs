//! The accuracy of a robot: at one state, and over its workspace.

use super::error::AccuracyStudyError;
use fivebar_design::accuracy::five_bar::{self, AccuracyAnalysis, AccuracyMap, ToolState};
use fivebar_files::robot::Robot;
use nalgebra::Vector2;

/// Analyses one state of a robot.
///
/// # Errors
/// `Place` with the reason why the arm cannot be in this state.
pub fn analyse(robot: &Robot, state: &ToolState) -> Result<AccuracyAnalysis, AccuracyStudyError> {
    five_bar::analyse(&robot.toleranced(), state).map_err(|reason| AccuracyStudyError::Place {
        place: state.position.into(),
        reason,
    })
}

/// Maps the accuracy of a robot at rest under a force on C [N], over its reach or over
/// `region`, which is [x0, y0, x1, y1] [m]; positions within the robot's singularity margin are
/// left out.
///
/// # Errors
/// `EmptyRegion`, or `NothingReached` if no cell of the region can be analysed.
pub fn accuracy_map(
    robot: &Robot,
    force: Vector2<f64>,
    region: Option<[f64; 4]>,
) -> Result<AccuracyMap, AccuracyStudyError> {
    let margin = robot.limits.singularity_margin;
    let map = five_bar::accuracy_map(&robot.toleranced(), margin, force, region)?;
    Ok(map)
}
