//! What the node tells of the arm: its joints, the frames of its links, and how it is.

use super::messages::{
    DiagnosticStatus, Diagnostics, Header, JointState, KeyValue, Quaternion, Transform,
    TransformStamped, Transforms, Vector3,
};
use fivebar_files::robot::Robot;
use fivebar_firmware::Status;
use fivebar_firmware::safety::{Fault, State};
use fivebar_kinematics::five_bar::{Pose, Side};
use fivebar_report::text::next_step;
use fivebar_sim::simulation::fault_name;
use std::f64::consts::{PI, TAU};

/// The frame of the base: its origin is A, its x axis points to E.
pub(super) const BASE: &str = "base";

/// The levels of a diagnostic.
const OK: u8 = 0;
const WARN: u8 = 1;
const ERROR: u8 = 2;

/// The arm's pose; none: its angles are not known, or no pose has them.
pub(super) fn pose(robot: &Robot, status: &Status) -> Option<Pose<f64>> {
    let tool = robot.tool_on_link().ok()?;
    let [theta1, theta4] = status.angle.map(f64::from);
    let [x, y] = status.tool.filter(|_| status.homed)?.map(f64::from);
    let off = |pose: &Pose<f64>| {
        let point = tool.point(pose);
        (point.x - x).hypot(point.y - y)
    };
    let poses = [Side::Left, Side::Right].map(|side| robot.geometry.forward(theta1, theta4, side));
    let poses = poses.into_iter().flatten();
    poses.min_by(|one, other| off(one).total_cmp(&off(other)))
}

/// Angles [rad], speeds [rad/s] and torques [N·m] of the joints, by the names of the exported URDF. A and E are driven.
pub(super) fn joint_state(robot: &Robot, status: &Status, pose: &Pose<f64>) -> JointState {
    let [theta1, theta4] = status.angle.map(f64::from);
    let [omega1, omega4] = status.velocity.map(f64::from);
    let [_, theta2, theta3, _] = pose.angles();
    let velocities = robot.geometry.forward_velocities(pose, omega1, omega4);
    let [_, omega2, omega3, _] = velocities.map_or([f64::NAN; 4], |velocities| velocities.omega);
    let [torque1, torque4] = status.torque.map(f64::from);
    JointState {
        header: Header::now(BASE),
        name: ["A", "B", "D", "E"].map(String::from).into(),
        position: vec![
            theta1,
            within_half_a_turn(theta2 - theta1),
            within_half_a_turn(theta3 - theta4),
            theta4,
        ],
        velocity: vec![omega1, omega2 - omega1, omega3 - omega4, omega4],
        effort: vec![torque1, 0.0, 0.0, torque4],
    }
}

/// The frames of the exported URDF.
pub(super) fn transforms(robot: &Robot, pose: &Pose<f64>) -> Transforms {
    let [theta1, theta2, theta3, theta4] = pose.angles();
    let [l1, l2, l3, l4, base] = robot.geometry.lengths();
    let [along, left] = robot.tool.offset;
    let header = Header::now(BASE);
    let frame = |parent: &str, child: &str, [x, y]: [f64; 2], angle: f64| TransformStamped {
        header: Header {
            frame_id: parent.into(),
            ..header.clone()
        },
        child_frame_id: child.into(),
        transform: Transform {
            translation: Vector3 { x, y, z: 0.0 },
            rotation: Quaternion {
                x: 0.0,
                y: 0.0,
                z: (0.5 * angle).sin(),
                w: (0.5 * angle).cos(),
            },
        },
    };
    Transforms {
        transforms: vec![
            frame(BASE, "link1", [0.0, 0.0], theta1),
            frame("link1", "link2", [l1, 0.0], theta2 - theta1),
            frame(BASE, "link4", [base, 0.0], theta4),
            frame("link4", "link3", [l4, 0.0], theta3 - theta4),
            frame("link2", "c_of_link2", [l2, 0.0], 0.0),
            frame("link3", "c_of_link3", [l3, 0.0], 0.0),
            frame("link2", "tool", [l2 + along, left], 0.0),
        ],
    }
}

/// How the arm is, and why the last motion ended if it failed.
pub(super) fn diagnostics(robot: &Robot, status: &Status, failure: Option<&str>) -> Diagnostics {
    let (level, message) = match (status.fault, status.state) {
        (Some(fault), _) => (
            ERROR,
            format!("{}: {}", fault_name(fault), next_step(fault)),
        ),
        (None, _) if !status.homed => (WARN, "not homed: call the service home".into()),
        (None, State::Stopped) => (OK, "at rest, motors off".into()),
        (None, State::Armed) => (OK, "at rest, motors on".into()),
        (None, state) => (OK, format!("{state:?}").to_lowercase()),
    };
    let value = |key: &str, value: String| KeyValue {
        key: key.into(),
        value,
    };
    let fault = status.fault.map_or(0, Fault::number);
    Diagnostics {
        header: Header::now(""),
        status: vec![DiagnosticStatus {
            level,
            name: "fivebar: arm".into(),
            message,
            hardware_id: robot.name.clone(),
            values: vec![
                value("fault", fault.to_string()),
                value("bus voltage [V]", format!("{:.1}", status.bus_voltage)),
                value("missed ticks", status.missed_ticks.to_string()),
                value("last motion", failure.unwrap_or("no failure").into()),
            ],
        }],
    }
}

/// The same angle in [−π, π).
fn within_half_a_turn(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::{joint_state, pose, transforms};
    use fivebar_files::robot::{BuiltIn, Robot};
    use fivebar_sim::controller::ControllerSource;
    use fivebar_sim::drive::Homing;
    use fivebar_sim::live::{LiveArm, Pace};
    use nalgebra::{Rotation2, Vector2};

    /// Where joints at these angles lead, from an axis on the base line [m, rad].
    fn leg(origin: f64, lengths: [f64; 2], [first, second]: [f64; 2]) -> Vector2<f64> {
        let out = |angle, length| Rotation2::new(angle) * Vector2::new(length, 0.0);
        Vector2::new(origin, 0.0) + out(first, lengths[0]) + out(first + second, lengths[1])
    }

    /// The tool by the frames, by the joints' angles, and by the controller.
    #[test]
    fn frames_and_joints_lead_to_the_tool_along_both_legs() {
        let robot = Robot::load(BuiltIn::DEFAULT).unwrap();
        let [l1, l2, l3, l4, base] = robot.geometry.lengths();
        let arm =
            LiveArm::open(&robot, ControllerSource::Simulated, Pace::AsFastAsPossible).unwrap();
        assert_eq!(
            pose(&robot, &arm.progress().status),
            None,
            "it is not homed"
        );
        arm.home(Homing::IfUnknown).unwrap().finish().unwrap();
        arm.motors_on().unwrap().finish().unwrap();
        let home = arm.progress().status.angle;
        for turn in [0.1, -0.15] {
            let to = [home[0] + turn, home[1] - 0.5 * turn];
            arm.move_joints(to, 0.5).unwrap().finish().unwrap();
            let status = arm.progress().status;
            let point = status.tool.unwrap().map(f64::from);
            let pose = pose(&robot, &status).unwrap();
            let joints = joint_state(&robot, &status, &pose);
            let [a, b, d, e] = joints.position[..] else {
                panic!("{joints:?}")
            };
            let ends = [leg(0.0, [l1, l2], [a, b]), leg(base, [l4, l3], [e, d])];
            for end in ends {
                assert!((end - Vector2::from(point)).norm() < 1e-6, "{end}");
            }
            let frames = transforms(&robot, &pose).transforms;
            let (mut place, mut direction) = (Vector2::zeros(), 0.0);
            for child in ["link1", "link2", "tool"] {
                let is_child = |frame: &&super::TransformStamped| frame.child_frame_id == child;
                let frame = &frames.iter().find(is_child).unwrap().transform;
                let (at, by) = (&frame.translation, &frame.rotation);
                place += Rotation2::new(direction) * Vector2::new(at.x, at.y);
                direction += 2.0 * by.z.atan2(by.w);
            }
            assert!((place - Vector2::from(point)).norm() < 1e-6, "{place}");
        }
    }
}
