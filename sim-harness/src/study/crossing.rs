//! Crossings of a singularity of type 2.
//!
//! The mechanics are in [`fivebar_design::crossing`].

use crate::input::robot::{MissingMasses, Robot};
use crate::run::crossing::CrossingRun;
use fivebar_design::crossing::{CrossingError, CrossingPlan, CrossingTask};
use nalgebra::Vector2;
use serde_json::{Value, json};

/// Why a crossing is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CrossingStudyError {
    /// The robot has lengths only.
    #[error(transparent)]
    Masses(#[from] MissingMasses),
    /// The robot file does not allow crossings.
    #[error(
        "robot `{0}`: its file does not allow crossings; write `allowed = true` under [crossing] \
         if its links clear each other where B, C and D are in line, or B meets D"
    )]
    NotAllowed(String),
    /// The tool is not at C.
    #[error("robot `{0}`: crossings are planned for a tool at C, but tool.offset is not zero")]
    Offset(String),
    /// The crossing cannot be planned.
    #[error(transparent)]
    Crossing(#[from] CrossingError),
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
    let arm = robot.arm()?;
    if !robot.crossing.allowed {
        return Err(CrossingStudyError::NotAllowed(robot.name.clone()));
    }
    if robot.tool.offset != [0.0; 2] {
        return Err(CrossingStudyError::Offset(robot.name.clone()));
    }
    let limits = &robot.limits;
    let motors = robot.actuators.as_ref();
    let friction = |of: fn(&crate::input::robot::Actuator) -> f64| {
        motors.map_or([0.0; 2], |motors| [of(&motors[0]), of(&motors[1])])
    };
    let mut torque = motors.map_or([f64::INFINITY; 2], |motors| {
        [motors[0].peak_torque(), motors[1].peak_torque()]
    });
    for (most, limit) in torque
        .iter_mut()
        .zip(limits.max_torque.unwrap_or([f64::INFINITY; 2]))
    {
        *most = most.min(limit);
    }
    Ok(CrossingTask {
        arm,
        mode: robot.elbows,
        viscous: friction(|motor| motor.viscous_friction),
        coulomb: friction(|motor| motor.coulomb_friction),
        torque,
        speed: limits.max_speed,
        acceleration: limits.max_acceleration,
        angle: limits.angle,
        elbow_margin: limits.singularity_margin,
        drag: robot.crossing.drag,
        from: Vector2::from(from),
        to: Vector2::from(to),
        time,
    })
}

/// The plan as one JSON object, in SI units, with the simulated run if there is one.
pub fn answer(plan: &CrossingPlan, run: Option<&CrossingRun>) -> Value {
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
    });
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
