//! Where the joints should be: a reference of the tool or of the joints, solved for both.

use super::model::Model;
use fivebar_kinematics::Vec2;
use fivebar_kinematics::five_bar::{PoseError, WorkingMode};
use fivebar_kinematics::trajectory::Reference;

/// What the joints should do when the torque of this tick acts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setpoint {
    /// u(θ1d), u(θ4d).
    pub(crate) direction: [Vec2<f32>; 2],
    /// ω1d, ω4d [rad/s].
    pub(crate) omega: [f32; 2],
    /// α1d, α4d [rad/s²].
    pub(crate) alpha: [f32; 2],
    /// It comes from a move of the joints.
    pub(crate) of_joints: bool,
}

impl Setpoint {
    /// Stand still in these directions.
    #[inline]
    pub(crate) fn hold(direction: [Vec2<f32>; 2]) -> Self {
        Self {
            direction,
            omega: [0.0; 2],
            alpha: [0.0; 2],
            of_joints: false,
        }
    }

    /// The joints' part in a reference, a tool's being solved in `mode`.
    #[inline(always)]
    pub(crate) fn of(
        reference: &Reference<f32>,
        model: &Model,
        mode: WorkingMode,
    ) -> Result<Self, PoseError> {
        match *reference {
            Reference::Tool {
                position,
                velocity,
                acceleration,
            } => {
                let tool = &model.tool;
                let pose = tool.inverse(position, mode)?;
                let velocities = tool.inverse_velocities(&pose, velocity)?;
                let accelerations = tool.inverse_accelerations(&pose, &velocities, acceleration)?;
                let [omega1, _, _, omega4] = velocities.omega;
                let [alpha1, _, _, alpha4] = accelerations.alpha;
                Ok(Self {
                    direction: [pose.u1, pose.u4],
                    omega: [omega1, omega4],
                    alpha: [alpha1, alpha4],
                    of_joints: false,
                })
            }
            Reference::Joint {
                angles,
                rates,
                accelerations,
            } => Ok(Self {
                direction: angles.map(Vec2::unit),
                omega: rates,
                alpha: accelerations,
                of_joints: true,
            }),
        }
    }
}
