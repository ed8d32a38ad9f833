//! The home pose of a robot, and the point where it moves best.

use super::{Limits, Robot};
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::{GeometryError, Pose, Side, Tool, WorkingMode};
use nalgebra::Vector2;

/// The robot has no pose in its working mode at home, or just before the home switches.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "robot `{0}` has no pose in its working mode at home, or just before the home switches, where \
     a run begins: give another `home = [θ1, θ4]` in radians, and `working_mode` if its elbows do \
     not point outwards"
)]
pub struct HomeError(pub String);

impl Robot {
    /// The pose at home, with the elbows of the file.
    ///
    /// # Errors
    /// At home no assembly mode gives these elbows.
    pub fn home_pose(&self) -> Result<Pose<f64>, HomeError> {
        self.pose_near_home([0.0; 2])
    }

    /// The pose with the joints at these angles from home [rad].
    ///
    /// # Errors
    /// As [`Robot::home_pose`].
    pub fn pose_near_home(&self, turned: [f64; 2]) -> Result<Pose<f64>, HomeError> {
        let [theta1, theta4] = [self.home[0] + turned[0], self.home[1] + turned[1]];
        Side::BOTH
            .into_iter()
            .filter_map(|assembly| self.geometry.forward(theta1, theta4, assembly).ok())
            .find(|pose| pose.working_mode() == self.elbows)
            .ok_or_else(|| HomeError(self.name.clone()))
    }

    /// The working mode of the tool at home, where leg 1 is A–B–tool. The controller and the
    /// workspace use this one. Without a home pose it is that of the file.
    pub fn working_mode(&self) -> WorkingMode {
        match (self.tool_on_link(), self.home_pose()) {
            (Ok(tool), Ok(home)) => tool.working_mode(&home),
            _ => self.elbows,
        }
    }

    /// The tool's position in a pose [m].
    pub fn tool_at(&self, pose: &Pose<f64>) -> [f64; 2] {
        let point = self.tool_on_link().map_or(pose.c, |tool| tool.point(pose));
        [point.x, point.y]
    }

    /// The tool's position with the greatest distance from singularities, of those with C in
    /// front of the middle of the base and on the branch of home; the home position, if there
    /// is none [m].
    ///
    /// # Errors
    /// As [`Robot::home_pose`].
    pub fn best_point(&self) -> Result<[f64; 2], HomeError> {
        let home = self.home_pose()?;
        let best = self.tool_on_link().ok().and_then(|tool| {
            let branch = |pose: &Pose<f64>| (tool.working_mode(pose), pose.assembly());
            let is_on_branch = |pose: &Pose<f64>| branch(pose) == branch(&home);
            best_conditioned(&tool, self.elbows, &self.limits, is_on_branch)
        });
        Ok(self.tool_at(&best.unwrap_or(home)))
    }

    /// The arm with its tool.
    ///
    /// # Errors
    /// The tool is at the elbow.
    pub fn tool_on_link(&self) -> Result<Tool<f64>, GeometryError> {
        let [along, left] = self.tool.offset;
        Tool::new(self.geometry, Vector2::new(along, left))
    }
}

/// The joint angles [rad] of the best conditioned pose; zero for an arm without any.
pub(super) fn default_home(tool: &Tool<f64>, elbows: WorkingMode, limits: &Limits) -> [f64; 2] {
    let pose = best_conditioned(tool, elbows, limits, |_| true);
    pose.map_or([0.0; 2], |pose| {
        [pose.u1.polar_angle(), pose.u4.polar_angle()]
    })
}

/// Of the poses with C in front of the middle of the base that `allowed` accepts, the one with
/// the greatest distance from singularities of the arm with its tool.
fn best_conditioned(
    tool: &Tool<f64>,
    elbows: WorkingMode,
    limits: &Limits,
    allowed: impl Fn(&Pose<f64>) -> bool,
) -> Option<Pose<f64>> {
    const STEPS: u32 = 400;
    let geometry = tool.geometry();
    let [l1, l2, l3, l4, base] = geometry.lengths();
    let reach = (l1 + l2).max(l3 + l4);
    let poses = (1..STEPS).filter_map(|step| {
        let c = Vector2::new(0.5 * base, reach * f64::from(step) / f64::from(STEPS));
        let pose = geometry.inverse(c, elbows).ok()?;
        let within_limits = limits.contain([pose.u1.polar_angle(), pose.u4.polar_angle()]);
        (within_limits && allowed(&pose)).then_some(pose)
    });
    let margin = |pose: &Pose<f64>| tool.nearest_singularity(pose).1;
    poses.max_by(|a, b| margin(a).total_cmp(&margin(b)))
}
