//! The controller's models against numbers from another method: Lagrange's equations of the
//! first kind, which were checked against MuJoCo.

use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, WorkingMode};
use fivebar_tests::vectors::{ReferenceArm, Vectors};
use nalgebra::Vector2;

fn vec2([x, y]: [f64; 2]) -> Vector2<f64> {
    Vector2::new(x, y)
}

fn arm(robot: &ReferenceArm) -> Arm<f64> {
    let links = [0, 1, 2, 3].map(|i| Link {
        mass: robot.mass[i],
        com: vec2(robot.com[i]),
        inertia: robot.inertia_about_com[i],
    });
    let geometry = Geometry::new(robot.link_lengths).unwrap();
    Arm::new(
        geometry,
        links,
        robot.payload,
        vec2(robot.gravity),
        [0.0; 2],
    )
    .unwrap()
}

#[track_caller]
fn assert_close<const N: usize>(what: &str, actual: [f64; N], expected: [f64; N]) {
    let scale = expected.iter().fold(1e-3_f64, |m, x| m.max(x.abs()));
    for (a, e) in actual.iter().zip(expected) {
        assert!(
            (a - e).abs() <= 1e-9 * scale,
            "{what}: {actual:?} for {expected:?}"
        );
    }
}

#[test]
fn all_180_states_agree_to_1e_9() {
    let vectors = Vectors::read();
    assert_eq!(vectors.cases.len(), 180);
    for case in &vectors.cases {
        let arm = arm(&vectors.robots[case.robot]);
        let g = arm.geometry();
        let pose = g.forward(case.theta1, case.theta4, case.assembly).unwrap();
        assert_close("c", [pose.c.x, pose.c.y], case.c);
        let [_, theta2, theta3, _] = pose.angles();
        assert_close("θ2, θ3", [theta2, theta3], [case.theta2, case.theta3]);
        let mode = WorkingMode::new(case.elbow1, case.elbow4);
        assert_eq!(pose.working_mode(), mode);
        let back = g.inverse(vec2(case.c), mode).unwrap();
        let [theta1, _, _, theta4] = back.angles();
        assert_close("inverse", [theta1, theta4], [case.theta1, case.theta4]);

        let rates = g
            .forward_velocities(&pose, case.omega1, case.omega4)
            .unwrap();
        assert_close(
            "ω2, ω3",
            [rates.omega[1], rates.omega[2]],
            [case.omega2, case.omega3],
        );
        assert_close("ṙC", [rates.c.x, rates.c.y], case.c_velocity);
        let acc = g
            .forward_accelerations(&pose, &rates, case.alpha1, case.alpha4)
            .unwrap();
        assert_close(
            "α2, α3",
            [acc.alpha[1], acc.alpha[2]],
            [case.alpha2, case.alpha3],
        );
        assert_close("r̈C", [acc.c.x, acc.c.y], case.c_acceleration);
        let back = g.inverse_velocities(&pose, vec2(case.c_velocity)).unwrap();
        assert_close("inverse ω", back.omega, rates.omega);
        let back = g
            .inverse_accelerations(&pose, &rates, vec2(case.c_acceleration))
            .unwrap();
        assert_close("inverse α", back.alpha, acc.alpha);

        let force = vec2(case.external_force);
        let torque = arm.inverse_dynamics(&pose, &rates, &acc, force).unwrap();
        assert_close("torque", torque, case.torque);
        let mass = arm.mass_matrix(&pose).unwrap();
        let [[m11, m14], [m41, m44]] = case.mass_matrix;
        assert_close(
            "M",
            [mass.m11, mass.m12, mass.m21, mass.m22],
            [m11, m14, m41, m44],
        );
        let effects = arm.nonlinear_effects(&pose, &rates, force).unwrap();
        assert_close("h", effects, case.bias_torque);
        let alpha = arm
            .forward_dynamics(&pose, &rates, case.torque, force)
            .unwrap();
        assert_close("forward dynamics", alpha, [case.alpha1, case.alpha4]);
        let reactions = arm.reactions(&pose, &rates, &acc, force).unwrap();
        for (name, actual, expected) in [
            ("a", reactions.a, case.reaction.a),
            ("b", reactions.b, case.reaction.b),
            ("c", reactions.c, case.reaction.c),
            ("d", reactions.d, case.reaction.d),
            ("e", reactions.e, case.reaction.e),
        ] {
            assert_close(name, [actual.x, actual.y], expected);
        }
        assert_close("torque by reactions", reactions.torque, case.torque);
    }
}
