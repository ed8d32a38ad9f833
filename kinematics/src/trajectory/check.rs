//! Whether a move may be made, and how fast: the whole path is verified, and the motion
//! limits follow from what it demands of the joints.

use super::envelope::Envelope;
use super::error::{ConstraintViolation, PathError, WithJoints};
use super::motion_limits::JointDemand;
use super::number::min;
use super::path_segment::PathSegment;
use super::ramp::MotionLimits;
use super::shares::{BendLimits, tool_limits};
use crate::Scalar;
use crate::five_bar::{Pose, Side};

impl<S: Scalar> Envelope<S> {
    /// Checks the whole of a path segment against the envelope. Returns its motion limits,
    /// with a speed of at most `speed` [m/s].
    ///
    /// Between any two of its points, too, an accepted path keeps the margin and the joint limits. Refused for its pose is
    /// a path that somewhere comes nearer to the margin than 1 % of it, nearer to a joint limit than
    /// 1 mrad, or so long along them that 20,000 steps do not prove it.
    ///
    /// # Errors
    /// The first point of the path that violates a constraint, and which constraint.
    pub fn check(
        &self,
        segment: &PathSegment<S>,
        speed: S,
    ) -> Result<MotionLimits<S>, PathError<S>> {
        self.check_from(segment, speed, None)
            .map(|(limits, _)| limits)
    }

    /// As [`Self::check`], from the joint angles θ1, θ4 [rad] on: where the joint limits are wider than a turn, they tell in
    /// which turn each joint begins. Without them it is the first that the limits allow. Returns also the angles at the end.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn check_from(
        &self,
        segment: &PathSegment<S>,
        speed: S,
        joints: Option<[S; 2]>,
    ) -> WithJoints<MotionLimits<S>, S> {
        let (limits, joints) = self.check_bend_from(segment, speed, joints)?;
        let limits = MotionLimits {
            speed: limits.middle,
            ..limits.halves
        };
        Ok((limits, joints))
    }

    /// As [`Self::check`], with a limit of its own for the speed in the middle.
    pub(super) fn check_bend(
        &self,
        segment: &PathSegment<S>,
        speed: S,
    ) -> Result<BendLimits<S>, PathError<S>> {
        self.check_bend_from(segment, speed, None)
            .map(|(limits, _)| limits)
    }

    fn check_bend_from(
        &self,
        segment: &PathSegment<S>,
        speed: S,
        joints: Option<[S; 2]>,
    ) -> WithJoints<BendLimits<S>, S> {
        let mut demand = JointDemand::none();
        let joints = self.verify_path(segment, joints, |point, pose| {
            demand.add_path(self, point, pose)
        })?;
        let tool = tool_limits(segment, speed, &self.tool_motion);
        let halves = demand.within(&tool.halves, self).ok_or(PathError {
            fraction: S::ZERO,
            point: segment.start(),
            violation: ConstraintViolation::Limits,
        })?;
        let middle = min(tool.middle, halves.speed);
        Ok((BendLimits { middle, halves }, joints))
    }

    /// Checks the whole of a straight joint move against the envelope. Links 2 and 3 must
    /// stay in the given assembly mode and keep the margin from the type 2 singularity, and
    /// the joints must stay within their limits. The move may pass a type 1 singularity:
    /// this is how the arm changes its working mode. `share`, in 0…1, is the share of the
    /// greatest joint speeds.
    ///
    /// Returns the motion limits of the joint that turns further, and the pose at the end.
    ///
    /// # Errors
    /// The first point of the path that violates a constraint, and which constraint.
    pub fn check_joint_move(
        &self,
        from: [S; 2],
        to: [S; 2],
        assembly: Side,
        share: S,
    ) -> Result<(MotionLimits<S>, Pose<S>), PathError<S>> {
        let mut demand = JointDemand::none();
        let end = self.verify_joint_path(from, to, assembly, |direction, pose| {
            demand.add_joint_path(self, direction, pose)
        })?;
        let ratio = self.tool_motion.jerk / self.tool_motion.acceleration;
        let limits = demand.joint_move_limits(share, ratio, self);
        let point = self.workspace.tool.point(&end);
        Ok((
            limits.ok_or(PathError {
                fraction: S::ZERO,
                point,
                violation: ConstraintViolation::Limits,
            })?,
            end,
        ))
    }
}
