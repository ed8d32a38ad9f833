//! The simulated arm, in full coordinates with constraint forces, against the controller's
//! model by Kane's method and against reference numbers made by a third program.

use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::{Pose, Side, Velocities};
use fivebar_plant::Mismatch;
use fivebar_plant::{Model, State};
use fivebar_tests::vectors::{ReferenceArm, Vectors};
use nalgebra::Vector2;
use proptest::prelude::*;
use std::fmt::Write as _;

/// The bandwidths are given only because finding them would take most of these tests' time.
/// With accelerations for which the drives of a file without motors have the torque, whatever the masses.
const CONTROL: &str = "[limits]\nmax_acceleration = [10, 10]\n[control]\nbandwidth = 100\nintegral_rate = 20\nobserver_bandwidth = 800\ncurrent_bandwidth = 2000\n";

/// The arm as a robot file, so that reading the file is tested too.
fn robot(arm: &ReferenceArm) -> Robot {
    let mut text = format!(
        "name = 'arm'\ngravity = {:?}\nbase = {:?}\npayload = {:?}\n",
        arm.gravity, arm.link_lengths[4], arm.payload
    );
    for i in 0..4 {
        writeln!(
            text,
            "[[link]]\nlength = {:?}\nmass = {:?}\ncom = {:?}\ninertia = {:?}",
            arm.link_lengths[i], arm.mass[i], arm.com[i], arm.inertia_about_com[i]
        )
        .unwrap();
    }
    text += CONTROL;
    Robot::parse("arm", &text).unwrap()
}

fn moving(
    model: &Model,
    robot: &Robot,
    pose: &Pose<f64>,
    omega: [f64; 2],
) -> (State, Velocities<f64>) {
    let rates = robot
        .geometry
        .forward_velocities(pose, omega[0], omega[1])
        .unwrap();
    (model.state_at(pose, rates.omega), rates)
}

#[track_caller]
fn assert_close<const N: usize>(what: &str, actual: [f64; N], expected: [f64; N], scale: f64) {
    for (a, e) in actual.iter().zip(expected) {
        assert!(
            (a - e).abs() <= scale,
            "{what}: {actual:?} for {expected:?}"
        );
    }
}

#[test]
fn the_plant_accelerates_and_bears_as_the_180_reference_states_say() {
    let vectors = Vectors::read();
    for case in &vectors.cases {
        let robot = robot(&vectors.robots[case.robot]);
        let model = Model::new(&robot.plant_parameters().unwrap(), &Mismatch::NONE);
        let pose = robot
            .geometry
            .forward(case.theta1, case.theta4, case.assembly)
            .unwrap();
        let (state, _) = moving(&model, &robot, &pose, [case.omega1, case.omega4]);
        let force = Vector2::from(case.external_force);
        let (a, forces) = model.accelerations(&state, case.torque, force);
        let scale = 1e-8 * case.alpha1.abs().max(case.alpha4.abs()).max(1.0);
        assert_close(
            "α",
            [a[0].angular, a[3].angular],
            [case.alpha1, case.alpha4],
            scale,
        );
        let r = &case.reaction;
        let expected = [r.a, r.b, r.c, r.d, r.e];
        // The plant gives the force on the body that is farther along A–B–C–D–E.
        let signs = [1.0, 1.0, 1.0, -1.0, -1.0];
        let largest = expected
            .iter()
            .flatten()
            .fold(1e-2, |m: f64, x| m.max(x.abs()));
        for k in 0..5 {
            let force = forces[k] * signs[k];
            assert_close("reaction", [force.x, force.y], expected[k], 1e-8 * largest);
        }
    }
}

prop_compose! {
    fn arms()(
        lengths in prop::array::uniform5(0.05..0.3_f64),
        mass in prop::array::uniform4(0.01..1.0_f64),
        radius in prop::array::uniform4(0.01..0.1_f64),
        com in prop::array::uniform4(prop::array::uniform2(-0.1..0.3_f64)),
        payload in 0.0..0.5_f64,
        gravity in prop::array::uniform2(-10.0..10.0_f64),
    ) -> ReferenceArm {
        let inertia_about_com = [0, 1, 2, 3].map(|i| mass[i] * radius[i] * radius[i]);
        ReferenceArm { link_lengths: lengths, mass, inertia_about_com, com, payload, gravity }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        max_global_rejects: 50_000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Where the arm is near a type 2 singularity its velocities grow without bound, and
    /// with them the rounding of either method; so they are compared at |sin| ≥ 0.05.
    #[test]
    fn plant_and_kane_agree_on_accelerations_to_1e_8(
        arm in arms(),
        theta1 in -3.1..3.1_f64,
        theta4 in -3.1..3.1_f64,
        left in any::<bool>(),
        omega in prop::array::uniform2(-10.0..10.0_f64),
        torque in prop::array::uniform2(-2.0..2.0_f64),
        force in prop::array::uniform2(-5.0..5.0_f64),
    ) {
        let [l1, l2, l3, l4, base] = arm.link_lengths;
        let longest = l1.max(l2).max(l3).max(l4).max(base);
        prop_assume!(2.0 * longest < l1 + l2 + l3 + l4 + base);
        let robot = robot(&arm);
        let assembly = if left { Side::Left } else { Side::Right };
        let Ok(pose) = robot.geometry.forward(theta1, theta4, assembly) else {
            return Err(TestCaseError::reject("cannot close"));
        };
        prop_assume!(pose.sin32().abs() > 0.05);
        let model = Model::new(&robot.plant_parameters().unwrap(), &Mismatch::NONE);
        let (state, rates) = moving(&model, &robot, &pose, omega);
        let (a, forces) = model.accelerations(&state, torque, Vector2::from(force));
        let force = Vector2::new(force[0], force[1]);
        let expected = robot.arm().unwrap().forward_dynamics(&pose, &rates, torque, force).unwrap();
        // The rounding is that of the distal links' terms, which near a singularity are many times
        // larger than the driven accelerations that they cancel to.
        let terms = a.iter().zip(&state.v).map(|(a, v)| a.angular.abs().max(v.angular.powi(2)));
        let scale = terms.fold(1.0, f64::max);
        // The plant turns each link about its centre of mass, as if free, by the motors' torques
        // and the joints' forces, which then take most of that away from each other.
        let pull = forces.iter().fold(0.0, |most: f64, force| most.max(force.norm()));
        let turn = torque[0].abs().max(torque[1].abs());
        let free = (0..4).map(|i| {
            let [along, aside] = arm.com[i];
            let lever = arm.link_lengths[i] + along.hypot(aside);
            (pull * lever + turn) / arm.inertia_about_com[i]
        });
        let rounding = 1e-8 * scale + 1e-12 * free.fold(0.0, f64::max);
        for (a, e) in [a[0].angular, a[3].angular].into_iter().zip(expected) {
            prop_assert!((a - e).abs() <= rounding, "{a} for {e}");
        }
    }
}
