//! Whether a move may be made, and how fast: its path walked and its loads weighed.

use super::envelope::Envelope;
use super::ramp::Caps;
use super::refusal::{Obstacle, Refusal};
use super::segment::Segment;
use super::speed_cap::{JointLoad, tool_caps};
use crate::Scalar;
use crate::five_bar::{Pose, Side};

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
