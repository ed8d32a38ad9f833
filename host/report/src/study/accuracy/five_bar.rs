//! The accuracy of a robot: at one state, and over its workspace.

use super::error::AccuracyStudyError;
use fivebar_design::accuracy::allocation::Allocation;
use fivebar_design::accuracy::five_bar::{
    self, AccuracyAnalysis, AccuracyMap, ArmTolerance, ToolState, cheapest_classes,
};
use fivebar_files::accuracy_classes::Classes;
use fivebar_files::robot::Robot;
use nalgebra::Vector2;

/// Why all deviations of a robot are 0, if its file has no tolerances.
pub fn without_tolerance(robot: &Robot) -> Option<&'static str> {
    (robot.tolerance == ArmTolerance::default()).then_some(
        "the file has no [tolerance], so all deviations are 0; its keys are length_sd, input_sd, input_max and \
         clearance_radius",
    )
}

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

/// The cheapest tolerances of a map.
#[derive(Clone, Debug)]
pub struct Cheapest {
    /// The choice with its cost.
    pub allocation: Allocation,
    /// Each dimension with the name of its class.
    pub names: Vec<(&'static str, String)>,
}

/// The cheapest of these classes that keep the radial standard deviation within `wanted` [m] all over a map.
///
/// # Errors
/// Even the finest classes do not.
pub fn cheapest(
    map: &AccuracyMap,
    wanted: f64,
    classes: &Classes,
) -> Result<Cheapest, AccuracyStudyError> {
    let allocation = cheapest_classes(map, wanted, &classes.inputs(), &classes.lengths());
    let allocation = allocation.ok_or(AccuracyStudyError::TooCoarse(wanted))?;
    let names = classes.names(&allocation.choice);
    Ok(Cheapest { allocation, names })
}
