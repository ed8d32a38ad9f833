//! Velocities and accelerations are the derivatives of positions, both ways.

use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::five_bar::Tool;
use fivebar_testkit::{Case, Moving, Tally, assert_close, mode, moving, pose, turned};
use nalgebra::Vector2;
use proptest::prelude::*;

fn offset() -> impl Strategy<Value = Vector2<f64>> {
    (-0.1..0.2_f64, -0.1..0.1_f64).prop_map(|(x, y)| Vector2::new(x, y))
}

/// Whether the angle at B from A–B to B–T has at least this sine, T being at `offset` from C.
fn is_bent(case: &Case, offset: Vector2<f64>, least: f64) -> bool {
    let bt = case.pose.c + offset.to_base_frame(case.pose.u2) - case.pose.b;
    case.pose.u1.cross_z(bt).abs() >= least * bt.norm()
}

/// A pose and a tool whose dyad A–B–T is bent too.
fn pose_with_tool(margin: f64) -> impl Strategy<Value = (Case, Vector2<f64>)> {
    (pose(margin), offset()).prop_filter("A–B–T in line", move |(case, offset)| {
        is_bent(case, *offset, margin)
    })
}

/// A motion and a tool whose dyad A–B–T is bent by |sin| ≥ 0.05.
fn moving_with_tool(
    offset: impl Strategy<Value = Vector2<f64>>,
) -> impl Strategy<Value = (Moving, Vector2<f64>)> {
    (moving(0.1), offset).prop_filter("A–B–T in line", |(moving, offset)| {
        is_bent(&moving.case, *offset, 0.05)
    })
}

/// Asserts that a component of a motion agrees to 1e-7 of the motion's size, the accuracy of the
/// finite differences.
#[track_caller]
fn assert_rate(what: &str, a: f64, b: f64, size: f64) {
    assert!(
        (a - b).abs() <= 1e-7 * size.max(1.0),
        "{what}: {a} for {b} of {size}"
    );
}

fn largest(values: [f64; 4]) -> f64 {
    values.into_iter().fold(0.0, |m, x| m.max(x.abs()))
}

proptest! {
    #[test]
    fn velocities_are_the_rates_of_positions(moving in moving(0.1)) {
        let (pose, velocities, _) = moving.now();
        let now = pose.angles();
        for (link, now) in now.into_iter().enumerate() {
            let angle = |t: f64| turned(moving.pose_at(t).angles()[link], now);
            let size = largest(velocities.omega);
            assert_rate("ω", velocities.omega[link], moving.rate(angle), size);
        }
        let speed = Vector2::new(moving.rate(|t| moving.pose_at(t).c.x), moving.rate(|t| moving.pose_at(t).c.y));
        assert_rate("ẋC", velocities.c.x, speed.x, velocities.c.norm());
        assert_rate("ẏC", velocities.c.y, speed.y, velocities.c.norm());
        let stands = moving.omega.iter().all(|omega| omega.abs() <= 0.1);
        prop_assert!(stands || velocities.c.norm() > 0.0, "the arm moves");
    }

    #[test]
    fn accelerations_are_the_rates_of_velocities(moving in moving(0.1)) {
        let (_, _, accelerations) = moving.now();
        for link in 0..4 {
            let omega = |t| moving.rates_at(t).1.omega[link];
            let size = largest(accelerations.alpha);
            assert_rate("α", accelerations.alpha[link], moving.rate(omega), size);
        }
        let acceleration = Vector2::new(
            moving.rate(|t| moving.rates_at(t).1.c.x),
            moving.rate(|t| moving.rates_at(t).1.c.y),
        );
        assert_rate("ẍC", accelerations.c.x, acceleration.x, largest(accelerations.alpha));
        assert_rate("ÿC", accelerations.c.y, acceleration.y, largest(accelerations.alpha));
        prop_assert!(accelerations.c.norm() > 0.0, "the arm accelerates");
    }

    #[test]
    fn inverse_motion_undoes_forward_motion(moving in moving(0.02)) {
        let (pose, velocities, accelerations) = moving.now();
        let geometry = moving.case.geometry;
        let back = geometry.inverse_velocities(&pose, velocities.c).unwrap();
        for (a, b) in back.omega.into_iter().zip(velocities.omega) {
            assert_close("ω", a, b, 1e-9);
        }
        let back = geometry.inverse_accelerations(&pose, &velocities, accelerations.c).unwrap();
        let scale = accelerations.alpha.iter().fold(1.0_f64, |m, a| m.max(a.abs()));
        for (a, b) in back.alpha.into_iter().zip(accelerations.alpha) {
            prop_assert!((a - b).abs() <= 1e-9 * scale);
        }
    }

    #[test]
    fn jacobians_give_the_same_velocities_and_undo_each_other(moving in moving(0.02)) {
        let (pose, velocities, _) = moving.now();
        let geometry = moving.case.geometry;
        let jacobian = geometry.jacobian(&pose).unwrap();
        let c = jacobian.velocity(moving.omega);
        assert_close("ẋC", c.x, velocities.c.x, 1e-10);
        assert_close("ẏC", c.y, velocities.c.y, 1e-10);
        let [omega1, omega4] = geometry.inverse_jacobian(&pose).unwrap().joint_rates(c);
        assert_close("ω1", omega1, moving.omega[0], 1e-9);
        assert_close("ω4", omega4, moving.omega[1], 1e-9);
        // Virtual work: τ·q̇ = F·ṙC.
        let force = Vector2::new(3.0, -2.0);
        let [torque1, torque4] = jacobian.torques(force);
        let power = torque1 * moving.omega[0] + torque4 * moving.omega[1];
        assert_close("power", power, force.dot(&c), 1e-10);
    }

    #[test]
    fn singular_values_bound_the_speed_and_multiply_to_the_determinant(case in pose(0.01)) {
        let jacobian = case.geometry.jacobian(&case.pose).unwrap();
        let [greatest, least] = jacobian.singular_values();
        assert_close("σσ", greatest * least, jacobian.manipulability(), 1e-12);
        let mut seen = (f64::INFINITY, 0.0_f64);
        for step in 0..720 {
            let direction = Vector2::unit(f64::from(step) * std::f64::consts::PI / 720.0);
            let speed = jacobian.velocity([direction.x, direction.y]).norm();
            prop_assert!(speed <= greatest * (1.0 + 1e-9) && speed >= least * (1.0 - 1e-9));
            seen = (seen.0.min(speed), seen.1.max(speed));
        }
        prop_assert!(seen.1 >= greatest * (1.0 - 1e-4), "the bound is reached");
        let condition = jacobian.inverse_condition();
        prop_assert!((0.0..=1.0).contains(&condition));
        assert_close("σmin/σmax", condition, least / greatest, 1e-9);
    }

    #[test]
    fn the_tool_moves_as_its_positions_say((moving, offset) in moving_with_tool(offset())) {
        let tool = Tool::new(moving.case.geometry, offset).unwrap();
        let (pose, velocities, accelerations) = moving.now();
        let velocity = tool.velocity(&pose, &velocities);
        assert_rate("ẋT", velocity.x, moving.rate(|t| tool.point(&moving.pose_at(t)).x), largest(velocities.omega));
        assert_rate("ẏT", velocity.y, moving.rate(|t| tool.point(&moving.pose_at(t)).y), largest(velocities.omega));
        let acceleration = tool.acceleration(&pose, &velocities, &accelerations);
        let at = |t| { let (pose, velocities) = moving.rates_at(t); tool.velocity(&pose, &velocities) };
        assert_rate("ẍT", acceleration.x, moving.rate(|t| at(t).x), largest(accelerations.alpha));
        assert_rate("ÿT", acceleration.y, moving.rate(|t| at(t).y), largest(accelerations.alpha));

        let back = tool.inverse_velocities(&pose, velocity).unwrap();
        for (a, b) in back.omega.into_iter().zip(velocities.omega) {
            assert_close("ω", a, b, 1e-9);
        }
        let back = tool.inverse_accelerations(&pose, &velocities, acceleration).unwrap();
        let scale = accelerations.alpha.iter().fold(1.0_f64, |m, a| m.max(a.abs()));
        for (a, b) in back.alpha.into_iter().zip(accelerations.alpha) {
            prop_assert!((a - b).abs() <= 1e-8 * scale);
        }
    }

    #[test]
    fn the_driven_joints_in_one_pass_are_those_of_the_inverse_solution(
        (moving, offset) in moving_with_tool(prop_oneof![Just(Vector2::zeros()), offset()])
    ) {
        let tool = Tool::new(moving.case.geometry, offset).unwrap();
        let (pose, velocities, accelerations) = moving.now();
        let t = tool.point(&pose);
        let driven = tool
            .actuated_joints(
                t,
                tool.velocity(&pose, &velocities),
                tool.acceleration(&pose, &velocities, &accelerations),
                tool.working_mode(&pose),
            )
            .unwrap();
        let [omega1, _, _, omega4] = velocities.omega;
        let [alpha1, _, _, alpha4] = accelerations.alpha;
        for (direction, expected) in driven.direction.into_iter().zip([pose.u1, pose.u4]) {
            prop_assert!((direction - expected).norm() < 1e-9);
        }
        assert_close("ω1", driven.omega[0], omega1, 1e-9);
        assert_close("ω4", driven.omega[1], omega4, 1e-9);
        let scale = accelerations.alpha.iter().fold(1.0_f64, |m, a| m.max(a.abs()));
        prop_assert!((driven.alpha[0] - alpha1).abs() <= 1e-8 * scale);
        prop_assert!((driven.alpha[1] - alpha4).abs() <= 1e-8 * scale);
    }

    #[test]
    fn a_tool_at_c_is_c(moving in moving(0.05)) {
        let Moving { case, .. } = moving;
        let tool = Tool::new(case.geometry, Vector2::zeros()).unwrap();
        let (pose, velocities, _) = moving.now();
        prop_assert_eq!(tool.point(&pose), pose.c);
        let mode = pose.working_mode();
        prop_assert_eq!(tool.working_mode(&pose), mode);
        let with = tool.inverse(pose.c, mode).unwrap();
        let without = case.geometry.inverse(pose.c, mode).unwrap();
        prop_assert!((with.d - without.d).norm() < 1e-12);
        let with = tool.inverse_velocities(&pose, velocities.c).unwrap();
        let without = case.geometry.inverse_velocities(&pose, velocities.c).unwrap();
        assert_close("ω4", with.omega[3], without.omega[3], 1e-12);
    }
}

#[test]
fn a_tool_offset_round_trips_on_every_branch() {
    let on_other_branches = Tally::default();
    proptest!(|((case, offset) in pose_with_tool(0.05), mode in mode())| {
        let tool = Tool::new(case.geometry, offset).unwrap();
        let t = tool.point(&case.pose);
        let own = tool.working_mode(&case.pose);
        let back = tool.inverse(t, own).unwrap();
        prop_assert!((back.c - case.pose.c).norm() < 1e-9);
        prop_assert!((back.b - case.pose.b).norm() < 1e-9);
        // With the other elbow of leg 1, C is elsewhere, possibly out of leg 4's reach.
        let other = tool.inverse(t, mode);
        prop_assert!(other.is_ok() || mode.elbow1 != own.elbow1);
        on_other_branches.count(other.is_ok());
        if let Ok(other) = other {
            prop_assert!((tool.point(&other) - t).norm() < 1e-12);
            prop_assert_eq!(tool.working_mode(&other), mode);
        }
    });
    on_other_branches.assert_accepted(0.75);
}

#[test]
fn a_tool_on_b_is_refused() {
    let geometry =
        fivebar_kinematics::five_bar::Geometry::new([0.1, 0.16, 0.16, 0.1, 0.08]).unwrap();
    assert!(Tool::new(geometry, Vector2::new(-0.16, 0.0)).is_err());
    assert!(Tool::new(geometry, Vector2::new(f64::NAN, 0.0)).is_err());
    assert!(Tool::new(geometry, Vector2::new(0.0, f64::INFINITY)).is_err());
    assert!(Tool::new(geometry, Vector2::new(0.03, -0.02)).is_ok());
}
