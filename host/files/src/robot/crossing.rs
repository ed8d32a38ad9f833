//! Crossings of a robot.

use super::{Actuator, MissingMasses, Robot};
use fivebar_design::crossing::CrossingTask;
use nalgebra::Vector2;

/// Why a robot crosses no singularity.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CrossingRefusal {
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
}

impl Robot {
    /// The crossing along a line between two points [m] in `time` [s], not planned yet, in the file's
    /// working mode.
    ///
    /// # Errors
    /// The robot file does not allow it.
    pub fn crossing_task(
        &self,
        [from, to]: [[f64; 2]; 2],
        time: f64,
    ) -> Result<CrossingTask<'_>, CrossingRefusal> {
        let arm = self.arm()?;
        if !self.crossing.allowed {
            return Err(CrossingRefusal::NotAllowed(self.name.clone()));
        }
        if self.tool.offset != [0.0; 2] {
            return Err(CrossingRefusal::Offset(self.name.clone()));
        }
        let limits = &self.limits;
        let motors = self.actuators.as_ref();
        let friction = |of: fn(&Actuator) -> f64| {
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
            mode: self.elbows,
            viscous: friction(|motor| motor.viscous_friction),
            coulomb: friction(|motor| motor.coulomb_friction),
            torque,
            speed: limits.max_speed,
            acceleration: limits.max_acceleration,
            angle: limits.angle,
            elbow_margin: limits.singularity_margin,
            drag: self.crossing.drag,
            from: Vector2::from(from),
            to: Vector2::from(to),
            time,
        })
    }
}
