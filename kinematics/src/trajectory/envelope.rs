//! What the arm may do: everything a path is held against before it is accepted.

use super::ramp::Caps;
use crate::dynamics::Arm;
use crate::five_bar::{Geometry, WorkingMode};

/// Limits of one driven joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits<S> {
    /// Least and greatest angle [rad]. Angles are told apart within one turn only, so
    /// limits a full turn apart or more are none.
    pub angles: [S; 2],
    /// Greatest speed [rad/s].
    pub speed: S,
    /// Greatest acceleration [rad/s²].
    pub acceleration: S,
}

/// Torques that a path may ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimits<S> {
    /// The masses.
    pub arm: Arm<S>,
    /// Greatest torque of joint 1 and joint 4 [N·m], friction not counted.
    pub torques: [S; 2],
}

/// The arm, its branch and its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope<S> {
    /// The lengths.
    pub geometry: Geometry<S>,
    /// The working mode kept along every path of the tool.
    pub mode: WorkingMode,
    /// Least |sin| of the angle at an elbow and at C: the distance kept from
    /// singularities of type 1 and 2. Positive, below 1.
    pub singularity_margin: S,
    /// Joint 1 and joint 4.
    pub joints: [JointLimits<S>; 2],
    /// Greatest speed, acceleration and jerk of the tool.
    pub tool: Caps<S>,
    /// How far a rounded corner may leave the path [m]; 0 stops at corners.
    pub corner_tolerance: S,
    /// Greatest torques, where the masses are known.
    pub torque: Option<TorqueLimits<S>>,
}
