//! The set-point: where the joints should be, solved from a reference of the tool or of the
//! joints.

use super::model::Model;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{ActuatedJointState, PoseError, WorkingMode};
use fivebar_kinematics::trajectory::Reference;
use nalgebra::Vector2;

/// What the joints should do at the time when this tick's torque acts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setpoint {
    /// u(θ1d), u(θ4d).
    pub(crate) direction: [Vector2<f32>; 2],
    /// ω1d, ω4d [rad/s].
    pub(crate) omega: [f32; 2],
    /// α1d, α4d [rad/s²].
    pub(crate) alpha: [f32; 2],
    /// It comes from a joint move.
    pub(crate) of_joints: bool,
}

impl Setpoint {
    /// At rest in these directions.
    #[inline]
    pub(crate) fn hold(direction: [Vector2<f32>; 2]) -> Self {
        Self {
            direction,
            omega: [0.0; 2],
            alpha: [0.0; 2],
            of_joints: false,
        }
    }

    /// Sets velocity and acceleration to zero; the directions stay.
    #[inline(always)]
    pub(crate) fn rest(&mut self) {
        self.omega = [0.0; 2];
        self.alpha = [0.0; 2];
        self.of_joints = false;
    }

    /// Sets the set-point to a reference; one of the tool is solved in working mode `mode`.
    #[inline(always)]
    pub(crate) fn follow(
        &mut self,
        reference: &Reference<f32>,
        model: &Model,
        mode: WorkingMode,
    ) -> Result<(), PoseError> {
        match *reference {
            Reference::Tool {
                position,
                velocity,
                acceleration,
            } => {
                let ActuatedJointState {
                    direction,
                    omega,
                    alpha,
                } = model
                    .tool
                    .actuated_joints(position, velocity, acceleration, mode)?;
                *self = Self {
                    direction,
                    omega,
                    alpha,
                    of_joints: false,
                };
            }
            Reference::Joint {
                angles,
                rates,
                accelerations,
            } => {
                *self = Self {
                    direction: angles.map(Vector2::unit),
                    omega: rates,
                    alpha: accelerations,
                    of_joints: true,
                };
            }
        }
        Ok(())
    }
}
