//! What the arm may do: everything a path is held against before it is accepted.

use super::ramp::Caps;
use crate::dynamics::Arm;
use crate::five_bar::Workspace;

/// Torques that a path may ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimits<S> {
    /// The masses.
    pub arm: Arm<S>,
    /// Greatest torque of joint 1 and joint 4 [N·m], friction not counted.
    pub torque: [S; 2],
}

/// The arm, its branch and its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope<S> {
    /// Where the tool may be: arm, tool, working mode, joint limits, singularity margin.
    /// Leg 1's singularity is the tool's: A, B and the tool in line. Where joint limits
    /// leave more than a turn, a path starts on the turn that `JointLimits::admit` gives.
    pub workspace: Workspace<S>,
    /// Greatest speed of joints 1 and 4 [rad/s].
    pub joint_speed: [S; 2],
    /// Greatest acceleration of joints 1 and 4 [rad/s²].
    pub joint_acceleration: [S; 2],
    /// Greatest torques, where the masses are known.
    pub torque: Option<TorqueLimits<S>>,
    /// Greatest speed, acceleration and jerk of the tool.
    pub tool_motion: Caps<S>,
    /// How far a rounded corner may leave the path [m]; 0 stops at corners.
    pub corner_tolerance: S,
}
