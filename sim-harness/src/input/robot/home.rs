//! Where a robot stands when nothing has moved it yet, and where it moves best.

use super::{Limits, Robot};
use fivebar_kinematics::Vec2;
use fivebar_kinematics::five_bar::{self, Geometry, Pose, Side, WorkingMode};

/// The home of a robot is not a pose of its working mode, or what lies before it is not.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "robot `{0}` has no pose in its working mode at home, or just before it, where a run begins: \
     state another `home = [θ1, θ4]` in radians, and `working_mode` if its elbows do not point \
     outwards"
)]
pub struct NoHome(pub String);

impl Robot {
    /// The pose at home, in the robot's working mode.
    ///
    /// # Errors
    /// None of the assembly branches is in that mode there.
    pub fn home_pose(&self) -> Result<Pose<f64>, NoHome> {
        self.pose_near_home([0.0; 2])
    }

    /// The pose with the joints turned from home by these angles [rad].
    ///
    /// # Errors
    /// As [`Robot::home_pose`].
    pub fn pose_near_home(&self, turned: [f64; 2]) -> Result<Pose<f64>, NoHome> {
        let [theta1, theta4] = [self.home[0] + turned[0], self.home[1] + turned[1]];
        Side::BOTH
            .into_iter()
            .filter_map(|assembly| self.geometry.forward(theta1, theta4, assembly).ok())
            .find(|pose| pose.working_mode() == self.working_mode)
            .ok_or_else(|| NoHome(self.name.clone()))
    }

    /// The tool in a pose [m].
    pub fn tool_at(&self, pose: &Pose<f64>) -> [f64; 2] {
        let [along, left] = self.tool.offset;
        let tool = five_bar::Tool::new(self.geometry, Vec2::new(along, left));
        let point = tool.map_or(pose.c, |tool| tool.point(pose));
        [point.x, point.y]
    }

    /// Where the tool is farthest from every singularity, in front of the middle of the
    /// base [m].
    ///
    /// # Errors
    /// There is no pose in front of it.
    pub fn best_point(&self) -> Result<[f64; 2], NoHome> {
        best_conditioned(&self.geometry, self.working_mode, &self.limits)
            .map(|pose| self.tool_at(&pose))
            .ok_or_else(|| NoHome(self.name.clone()))
    }
}

/// The pose with C in front of the middle of the base that keeps farthest from every
/// singularity.
pub(super) fn best_conditioned(
    geometry: &Geometry<f64>,
    mode: WorkingMode,
    limits: &Limits,
) -> Option<Pose<f64>> {
    const STEPS: u32 = 400;
    let [l1, l2, l3, l4, base] = geometry.lengths();
    let reach = (l1 + l2).max(l3 + l4);
    let poses = (1..STEPS).filter_map(|step| {
        let c = Vec2::new(0.5 * base, reach * f64::from(step) / f64::from(STEPS));
        let pose = geometry.inverse(c, mode).ok()?;
        let allowed = limits.contain([pose.u1.angle(), pose.u4.angle()]);
        allowed.then_some(pose)
    });
    let margin = |pose: &Pose<f64>| pose.nearest_singularity().1;
    poses.max_by(|a, b| margin(a).total_cmp(&margin(b)))
}
