//! The controller's models against numbers made by an unlike method: Lagrange's equations
//! of the first kind, themselves checked against MuJoCo.

use fivebar_kinematics::Vec2;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
use serde::Deserialize;

#[derive(Deserialize)]
struct Vectors {
    robots: Vec<Robot>,
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Robot {
    link_lengths: [f64; 5],
    mass: [f64; 4],
    inertia_about_com: [f64; 4],
    com: [[f64; 2]; 4],
    payload: f64,
    gravity: [f64; 2],
}

#[derive(Deserialize)]
struct Case {
    robot: usize,
    theta1: f64,
    theta4: f64,
    omega1: f64,
    omega4: f64,
    alpha1: f64,
    alpha4: f64,
    assembly: String,
    elbow1: String,
    elbow4: String,
    external_force: [f64; 2],
    c: [f64; 2],
    c_velocity: [f64; 2],
    c_acceleration: [f64; 2],
    omega2: f64,
    omega3: f64,
    alpha2: f64,
    alpha3: f64,
    theta2: f64,
    theta3: f64,
    torque: [f64; 2],
    mass_matrix: [[f64; 2]; 2],
    bias_torque: [f64; 2],
    reaction: Reaction,
}

#[derive(Deserialize)]
struct Reaction {
    a: [f64; 2],
    b: [f64; 2],
    c: [f64; 2],
    d: [f64; 2],
    e: [f64; 2],
}

fn side(name: &str) -> Side {
    match name {
        "left" => Side::Left,
        "right" => Side::Right,
        other => panic!("no such side: {other}"),
    }
}

fn vec2([x, y]: [f64; 2]) -> Vec2<f64> {
    Vec2::new(x, y)
}

fn arm(robot: &Robot) -> Arm<f64> {
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
    let vectors: Vectors =
        serde_json::from_str(include_str!("../data/five_bar_vectors.json")).unwrap();
    assert_eq!(vectors.cases.len(), 180);
    for case in &vectors.cases {
        let arm = arm(&vectors.robots[case.robot]);
        let g = arm.geometry();
        let pose = g
            .forward(case.theta1, case.theta4, side(&case.assembly))
            .unwrap();
        assert_close("c", [pose.c.x, pose.c.y], case.c);
        let [_, theta2, theta3, _] = pose.angles();
        assert_close("θ2, θ3", [theta2, theta3], [case.theta2, case.theta3]);
        let mode = WorkingMode::new(side(&case.elbow1), side(&case.elbow4));
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
            [mass.m11, mass.m14, mass.m14, mass.m44],
            [m11, m14, m41, m44],
        );
        let bias = arm.bias(&pose, &rates, force).unwrap();
        assert_close("h", bias, case.bias_torque);
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
