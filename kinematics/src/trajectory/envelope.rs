//! The constraints that a path must satisfy before it is accepted.

use super::ramp::MotionLimits;
use crate::dynamics::Arm;
use crate::five_bar::Workspace;

/// The torques that a path may demand.
///
/// ```
/// use fivebar_kinematics::dynamics::{Arm, Link};
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::TorqueLimits;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(0.06, length)); // kg, m
/// let arm = Arm::new(geometry, rods, 0.03, Vector2::new(0.0, -9.81), [2e-5; 2])?;
/// let limits = TorqueLimits { arm, torque: [0.4, 0.4] }; // N·m
/// // Enough to hold the arm up at this pose.
/// let pose = geometry.inverse(Vector2::new(0.04, 0.20), WorkingMode::new(Side::Right, Side::Left))?;
/// let hold = limits.arm.gravity_torque(&pose)?;
/// assert!(hold[0].abs() < limits.torque[0] && hold[1].abs() < limits.torque[1]);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimits<S> {
    /// The arm with its masses.
    pub arm: Arm<S>,
    /// Greatest torque of joint 1 and joint 4 [N·m], without friction.
    pub torque: [S; 2],
}

/// The arm, its branch and its limits.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::{Envelope, MotionLimits, PathSegment};
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let (tool, mode) = (Tool::new(geometry, Vector2::zeros())?, WorkingMode::new(Side::Right, Side::Left));
/// let envelope = Envelope {
///     workspace: Workspace { tool, mode, limits: None, margin: 0.15 },
///     joint_speed: [20.0; 2],           // rad/s
///     joint_acceleration: [2000.0; 2],  // rad/s²
///     torque: None,
///     tool_motion: MotionLimits { speed: 1.0, acceleration: 10.0, jerk: 1000.0 },
///     corner_tolerance: 1e-4,           // m
/// };
/// let line = PathSegment::line(Vector2::new(0.01, 0.18), Vector2::new(0.07, 0.18))?;
/// // The whole line is allowed, at no more than the speed asked for [m/s].
/// assert!(envelope.check(&line, 0.3)?.speed <= 0.3);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Envelope<S> {
    /// Where the tool may be: arm, tool, working mode, joint limits, singularity margin.
    /// Leg 1 is singular where A, B and the tool are in line. Where joint limits
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
