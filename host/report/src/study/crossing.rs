//! Crossings of a singularity of type 2.
//!
//! The mechanics are in [`fivebar_design::crossing`].

use fivebar_design::crossing::{CrossingError, CrossingPlan, CrossingTask};
use fivebar_files::robot::{CrossingRefusal, MissingMasses, Robot};
use fivebar_files::scenario::crossing_move;
use fivebar_firmware::planner::MoveError;
use fivebar_firmware::settings::SettingsError;
use fivebar_firmware::{Move, Planner};
use fivebar_sim::crossing::CrossingRun;
use serde_json::{Value, json};

/// Why a crossing is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CrossingStudyError {
    /// The robot crosses none.
    #[error(transparent)]
    Robot(#[from] CrossingRefusal),
    /// The crossing cannot be planned.
    #[error(transparent)]
    Crossing(#[from] CrossingError),
}

/// Why the controller would not do a crossing that the host has planned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ControllerRefusal {
    /// The robot has lengths only.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// Its settings would be refused.
    #[error("the robot's settings are not valid: {0}")]
    Settings(SettingsError),
    /// Its own check of the move.
    #[error(transparent)]
    Move(#[from] MoveError),
}

/// Plans a crossing along a line between two points [m] in `time` [s].
///
/// # Errors
/// The robot file does not allow it, or the line, the time, a limit or the drag forbids it.
pub fn plan(
    robot: &Robot,
    ends: [[f64; 2]; 2],
    time: f64,
) -> Result<CrossingPlan, CrossingStudyError> {
    Ok(task(robot, ends, time)?.plan()?)
}

/// The crossing of a robot along a line between two points [m] in `time` [s], not planned yet.
///
/// # Errors
/// The robot file does not allow it.
pub fn task(
    robot: &Robot,
    [from, to]: [[f64; 2]; 2],
    time: f64,
) -> Result<CrossingTask<'_>, CrossingStudyError> {
    Ok(robot.crossing_task([from, to], time)?)
}

/// Asks the controller's own planner whether it would accept a crossing of an arm that is held where
/// the line begins.
///
/// # Errors
/// Why not.
pub fn check_by_controller(
    robot: &Robot,
    task: &CrossingTask<'_>,
    plan: &CrossingPlan,
) -> Result<(), ControllerRefusal> {
    let settings = robot.settings()?;
    let settings = settings.check().map_err(ControllerRefusal::Settings)?;
    let planner = Planner::new(&settings)
        .in_mode(task.mode)
        .in_assembly(plan.assembly[0]);
    let crossing = Move {
        tag: 0,
        tool: 0,
        kind: crossing_move(task, plan),
    };
    let from = [task.from.x as f32, task.from.y as f32];
    planner.check(from, &crossing)?;
    Ok(())
}

/// The plan as one JSON object, in SI units, with what the controller says of it, and with the simulated
/// run if there is one.
pub fn answer(
    plan: &CrossingPlan,
    controller: &Result<(), ControllerRefusal>,
    run: Option<&CrossingRun>,
) -> Value {
    let mut answer = json!({
        "tc": plan.t_c,
        "s_c": plan.s_c,
        "s_dot_c": plan.s_dot_c,
        "s_ddot_c": plan.s_ddot_c,
        "N": [plan.condition.n.x, plan.condition.n.y],
        "f0": plan.condition.f0,
        "condition": plan.value,
        "polynomial_in_t_over_tf": plan.law.coefficients,
        "peak_torque": plan.peak_torque,
        "assembly": plan.assembly,
        "controller": { "accepts": controller.is_ok() },
    });
    if let Err(refusal) = controller {
        answer["controller"]["reason"] = refusal.to_string().into();
    }
    if let Some(run) = run {
        answer["simulated"] = json!({
            "assembly": run.assembly,
            "tip_error_m": run.tip_error,
            "end_error_m": run.end_error,
            "saturated_ticks": run.saturated_ticks,
            "unpowered_at_s": run.unpowered_at,
        });
    }
    answer
}
