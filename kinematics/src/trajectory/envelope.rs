//! The constraints that a path must satisfy before it is accepted.

use super::ramp::MotionLimits;
use crate::dynamics::Arm;
use crate::five_bar::Workspace;

/// The torques that a path may demand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimits<S> {
    /// The arm with its masses.
    pub arm: Arm<S>,
    /// Greatest torque of joint 1 and joint 4 [N·m], without friction.
    pub torque: [S; 2],
}

/// The arm, its branch and its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope<S> {
    /// Where the tool may be: arm, tool, working mode, joint limits, singularity margin.
    /// Leg 1's singularity is the tool's: A, B and the tool in line. Where joint limits
    /// span more than one turn, a path starts at the angles that
    /// `JointLimits::angles_within` returns.
    pub workspace: Workspace<S>,
    /// Greatest speed of joints 1 and 4 [rad/s].
    pub joint_speed: [S; 2],
    /// Greatest acceleration of joints 1 and 4 [rad/s²].
    pub joint_acceleration: [S; 2],
    /// Greatest torques; `None` where the masses are unknown.
    pub torque: Option<TorqueLimits<S>>,
    /// Greatest speed, acceleration and jerk of the tool.
    pub tool_motion: MotionLimits<S>,
    /// Greatest distance of a rounded corner from the path [m]. With 0 the motion stops at
    /// corners.
    pub corner_tolerance: S,
}
