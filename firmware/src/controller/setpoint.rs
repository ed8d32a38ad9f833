//! The set-point: where the joints should be, solved from a reference of the tool or of the
//! joints.

use super::model::Model;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{ActuatedJointState, Joint, PoseError, WorkingMode};
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
}

impl Setpoint {
    /// At rest in these directions.
    #[inline]
    pub(crate) fn hold(direction: [Vector2<f32>; 2]) -> Self {
        Self {
            direction,
            omega: [0.0; 2],
            alpha: [0.0; 2],
        }
    }

    /// Direction, velocity and acceleration of one joint.
    #[inline(always)]
    pub(crate) fn of(&self, joint: Joint) -> Option<(Vector2<f32>, f32, f32)> {
        let direction = self.direction.get(joint.index())?;
        Some((
            *direction,
            *self.omega.get(joint.index())?,
            *self.alpha.get(joint.index())?,
        ))
    }

    /// Sets velocity and acceleration to zero; the directions stay.
    #[inline(always)]
    pub(crate) fn rest(&mut self) {
        self.omega = [0.0; 2];
        self.alpha = [0.0; 2];
    }

    /// Sets the set-point to a reference; one of the tool is solved in working mode `mode`, one
    /// of the joints may change it.
    #[inline(always)]
    pub(crate) fn follow(
        &mut self,
        reference: &Reference<f32>,
        model: &Model,
        mode: &mut WorkingMode,
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
                    .actuated_joints(position, velocity, acceleration, *mode)?;
                *self = Self {
                    direction,
                    omega,
                    alpha,
                };
            }
            Reference::Joint {
                angles,
                rates,
                accelerations,
            } => self.follow_joints(angles, rates, accelerations, model, mode),
        }
        Ok(())
    }

    /// Sets the set-point to a reference of the joints, angles in rad. The working mode is then
    /// that of the reference.
    // Not inlined: the tick of an arm that follows its tool keeps its registers.
    #[inline(never)]
    fn follow_joints(
        &mut self,
        angles: [f32; 2],
        omega: [f32; 2],
        alpha: [f32; 2],
        model: &Model,
        mode: &mut WorkingMode,
    ) {
        let [u1, u4] = Vector2::units(angles);
        let tool = &model.tool;
        // Where the links do not meet, the measured arm raises the fault.
        if let Ok(links) = tool.geometry().links(u1, u4, model.assembly) {
            *mode = tool.working_mode(&tool.geometry().pose(&links));
        }
        *self = Self {
            direction: [u1, u4],
            omega,
            alpha,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fivebar_kinematics::PlanarVector;

    #[test]
    fn a_set_point_that_comes_to_rest_stays_where_it_is() {
        let direction = [2.0, 1.0].map(Vector2::unit);
        let mut setpoint = Setpoint {
            direction,
            omega: [3.0, -4.0],
            alpha: [900.0, -700.0],
        };
        setpoint.rest();
        assert_eq!(setpoint.direction, direction);
        assert_eq!((setpoint.omega, setpoint.alpha), ([0.0; 2], [0.0; 2]));
    }
}
