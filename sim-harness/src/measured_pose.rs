//! The pose that a controller measures.

use fivebar_firmware::Status;
use fivebar_kinematics::five_bar::{Pose, Side, Tool};
use nalgebra::Vector2;

/// The pose that a controller measures; none until the arm is homed. θ1 and θ4 are the same in both
/// assembly modes: it is the one that has the tool where the controller says.
pub fn measured_pose(tool: &Tool<f32>, status: &Status) -> Option<Pose<f32>> {
    let [theta1, theta4] = status.angle;
    let place = Vector2::from(status.tool.filter(|_| status.homed)?);
    let away = |pose: &Pose<f32>| (tool.point(pose) - place).norm();
    [Side::Left, Side::Right]
        .into_iter()
        .filter_map(|assembly| tool.geometry().forward(theta1, theta4, assembly).ok())
        .min_by(|a, b| away(a).total_cmp(&away(b)))
}
