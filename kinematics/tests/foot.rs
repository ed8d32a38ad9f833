//! What the motors of a leg need, in one pass, against the inverse solution and its Jacobian.

use fivebar_kinematics::five_bar::{
    Geometry, PoseError, Side, Singularity, Unreachable, WorkingMode,
};
use fivebar_testkit::{assert_close, pose, turned};
use nalgebra::Vector2;
use proptest::prelude::*;

#[test]
fn one_pass_gives_what_inverse_rates_and_jacobian_give() {
    let coordinate = || -2.0..2.0_f64;
    proptest!(|(case in pose(1e-2), [vx, vy] in [coordinate(), coordinate()],
                [fx, fy] in [coordinate(), coordinate()])| {
        let (geometry, pose) = (case.geometry, case.pose);
        let (velocity, force) = (Vector2::new(vx, vy), Vector2::new(fx, fy));
        let motors = geometry.drive_foot(pose.c, velocity, force, pose.working_mode()).unwrap();
        let [theta1, _, _, theta4] = pose.angles();
        let [omega1, _, _, omega4] = geometry.inverse_velocities(&pose, velocity).unwrap().omega;
        let torques = geometry.jacobian(&pose).unwrap().torques(force);
        for joint in 0..2 {
            prop_assert!(turned(motors.angle[joint], [theta1, theta4][joint]).abs() < 1e-8);
            let size = |a: f64| 1e-8 * (1.0 + a.abs());
            let (rate, torque) = ([omega1, omega4][joint], -torques[joint]);
            assert_close("rate", motors.rate[joint], rate, size(rate));
            assert_close("torque", motors.torque[joint], torque, size(torque));
        }
    });
}

#[test]
fn what_inverse_rates_and_jacobian_refuse_is_refused_alike() {
    let refusal = |leg: Geometry<f64>, foot: [f64; 2], mode| {
        let rest = Vector2::zeros();
        leg.drive_foot(Vector2::from(foot), rest, rest, mode).err()
    };
    let symmetric = Geometry::new([0.09, 0.16, 0.16, 0.09, 0.04]).unwrap();
    let knees_out = WorkingMode::new(Side::Left, Side::Right);
    let far = Some(PoseError::Unreachable(Unreachable::Leg1TooFar));
    assert_eq!(refusal(symmetric, [0.02, -0.3], knees_out), far);
    let stretched = Some(PoseError::Singular(Singularity::Leg1));
    assert_eq!(refusal(symmetric, [0.0, -0.25], knees_out), stretched);
    // Coaxial hips and both knees on the same side: B and D meet.
    let coaxial = Geometry::new([0.09, 0.16, 0.16, 0.09, 0.0]).unwrap();
    let together = WorkingMode::new(Side::Left, Side::Left);
    let parallel = Some(PoseError::Singular(Singularity::Parallel));
    assert_eq!(refusal(coaxial, [0.02, -0.2], together), parallel);
}
