//! What the arm may do: everything a path is held against before it is accepted.

use super::ramp::Caps;
use super::refusal::{Obstacle, Refusal};
use super::segment::Segment;
use super::speed_cap::{JointLoad, tool_caps};
use crate::dynamics::Arm;
use crate::five_bar::{Pose, Side, Workspace};
use crate::{Scalar, Vec2};

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

impl<S: Scalar> Envelope<S> {
    /// Hold the whole of a segment against the envelope, and say how fast it may be moved
    /// along, `speed` [m/s] at most.
    ///
    /// # Errors
    /// The first place that cannot be passed, and why.
    pub fn admit(&self, segment: &Segment<S>, speed: S) -> Result<Caps<S>, Refusal<S>> {
        let mut load = JointLoad::none();
        self.walk(segment, |point, pose| load.add_path(self, point, pose))?;
        load.within(&tool_caps(segment, speed, &self.tool_motion), self)
            .ok_or(Refusal {
                fraction: S::ZERO,
                point: segment.start(),
                obstacle: Obstacle::Limits,
            })
    }

    /// Hold the whole of a straight joint move against the envelope: links 2 and 3 must
    /// stay assembled on the given side, the margin from type 2 kept, and both ends be
    /// within the joints' limits. Type 1 may be passed: that is how a working mode is
    /// changed. `share` in 0…1 is of the greatest joint speeds.
    ///
    /// Gives the caps, of the joint that turns further, and the pose at the end.
    ///
    /// # Errors
    /// The first place that cannot be passed, and why.
    pub fn admit_joint_move(
        &self,
        from: [S; 2],
        to: [S; 2],
        assembly: Side,
        share: S,
    ) -> Result<(Caps<S>, Pose<S>), Refusal<S>> {
        let mut load = JointLoad::none();
        let end = self.walk_joints(from, to, assembly, |direction, pose| {
            load.add_joint_path(self, direction, pose)
        })?;
        let ratio = self.tool_motion.jerk / self.tool_motion.acceleration;
        let caps = load.joint_caps(share, ratio, self);
        let point = self.workspace.tool.point(&end);
        Ok((
            caps.ok_or(Refusal {
                fraction: S::ZERO,
                point,
                obstacle: Obstacle::Limits,
            })?,
            end,
        ))
    }
}

/// A vector with nothing in it that is infinite or not a number.
pub(super) fn is_finite<S: Scalar>(v: Vec2<S>) -> bool {
    v.x.is_finite() && v.y.is_finite()
}
