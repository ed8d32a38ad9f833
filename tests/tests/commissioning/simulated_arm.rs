//! Identification on the simulated arm, whose equations are not those of the regressor.

use crate::logs::setup;
use crate::truth::base_with;
use fivebar_design::identification::{
    Identification, Regressor, base_parameters, physical_links, standard_parameters,
};
use fivebar_files::robot::Robot;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Joint, Side};
use fivebar_plant::Mismatch;
use fivebar_report::study::identification::{identify_robot, propose_for};
use fivebar_sim::excitation::excite;

/// Benchtop, or the same arm in an upright plane.
fn robot(upright: bool) -> Robot {
    let text =
        Robot::load("benchtop").map(|_| include_str!("../../../host/files/robots/benchtop.toml"));
    let text = text.unwrap();
    let text = if upright {
        text.replace("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]")
    } else {
        text.to_owned()
    };
    Robot::parse("benchtop.toml", &text).unwrap()
}

/// Root mean square of the torque that base parameters and friction do not predict along an
/// excitation [N·m].
fn misprediction(
    robot: &Robot,
    upright: bool,
    base: &[f64],
    friction: [[f64; 2]; 2],
) -> (f64, f64) {
    let setup = setup(upright, 1);
    let used = if upright { 11 } else { 7 };
    let (truth, mut wrong, mut whole) = (base_with(robot, &Mismatch::default()), 0.0, 0.0);
    for step in 0..1000 {
        let motion = setup.excitation.at(1.25e-3 * f64::from(step));
        let at = Regressor::at(&robot.geometry, Side::Left, robot.gravity, motion).unwrap();
        let (own, real) = (at.torque(&base[..used]), at.torque(&truth[..used]));
        for joint in 0..2 {
            let omega = motion[1][joint];
            let [viscous, coulomb] = friction[joint];
            let torque = real[joint] + 1.95e-3 * omega + 11.7e-3 * omega.signum();
            let predicted = own[joint] + viscous * omega + coulomb * omega.signum();
            wrong += (torque - predicted).powi(2) / 2000.0;
            whole += torque * torque / 2000.0;
        }
    }
    (wrong.sqrt(), whole.sqrt())
}

fn judged(robot: &Robot, upright: bool, found: &Identification) {
    let truth = base_with(robot, &Mismatch::default());
    for (index, (own, wanted)) in found.base.iter().zip(&truth).enumerate() {
        println!(
            "{index}: {own:.5e} {wanted:.5e} sd {:.1e}",
            found.base_sd[index]
        );
    }
    println!("{found:?}");
    for index in [0, 1, 2, 4]
        .into_iter()
        .chain(if upright { vec![7, 9] } else { vec![] })
    {
        let error = (found.base[index] / truth[index] - 1.0).abs();
        assert!(error < 0.01, "{index}: {error}");
    }
    for joint in 0..2 {
        assert!(
            (found.viscous[joint] / 1.95e-3 - 1.0).abs() < 0.02,
            "{:?}",
            found.viscous
        );
        assert!(
            (found.coulomb[joint] / 11.7e-3 - 1.0).abs() < 0.02,
            "{:?}",
            found.coulomb
        );
    }
    let friction = Joint::ALL.map(|joint| [found.viscous[joint], found.coulomb[joint]]);
    let (after, whole) = misprediction(robot, upright, &found.base, friction);
    let drawn = robot.arm().unwrap();
    let base = base_parameters(robot.geometry.lengths(), &standard_parameters(drawn));
    let (before, _) = misprediction(robot, upright, &base, [[1.5e-3, 9e-3]; 2]);
    println!("before {before:.2e}, after {after:.2e} of {whole:.2e} N·m");
    assert!(after < 0.01 * whole && 10.0 * after < before);
}

#[test]
fn physical_links_have_the_torques_of_their_base_parameters() {
    for upright in [false, true] {
        let robot = robot(upright);
        let used = if upright { 11 } else { 7 };
        let truth = base_with(&robot, &Mismatch::default());
        let truth = &truth[..used];
        let drawn = robot.arm().unwrap();
        let found = physical_links(drawn, truth).unwrap();
        assert!(found.difference < 1e-5, "{}", found.difference);
        let (payload, rotors) = (drawn.payload(), drawn.rotor_inertia());
        let arm = Arm::new(
            robot.geometry,
            found.links,
            payload,
            drawn.gravity(),
            rotors,
        )
        .unwrap();
        // By Kane's equations along the second trajectory.
        let excitation = setup(upright, 1).excitation;
        for step in 0..100 {
            let motion = excitation.at(0.0125 * f64::from(step));
            let [q, omega, alpha] = motion;
            let geometry = &robot.geometry;
            let pose = geometry.forward(q[0], q[1], Side::Left).unwrap();
            let rates = geometry
                .forward_velocities(&pose, omega[0], omega[1])
                .unwrap();
            let accelerations = geometry
                .forward_accelerations(&pose, &rates, alpha[0], alpha[1])
                .unwrap();
            let kane = arm.inverse_dynamics(&pose, &rates, &accelerations, Default::default());
            let at = Regressor::at(geometry, Side::Left, robot.gravity, motion).unwrap();
            for (kane, wanted) in kane.unwrap().into_iter().zip(at.torque(truth)) {
                assert!((kane - wanted).abs() < 1e-5, "{kane} {wanted}");
            }
        }
    }
}

#[test]
fn the_simulated_arm_is_identified_level_and_upright() {
    for upright in [false, true] {
        let robot = robot(upright);
        let excitation = setup(upright, 0).excitation;
        let rows = excite(&robot, &excitation, 4, &Mismatch::default(), 3).unwrap();
        judged(&robot, upright, &identify_robot(&robot, &rows).unwrap());
    }
}

#[test]
fn the_simulated_arm_is_identified_by_its_own_proposal() {
    let robot = robot(false);
    let [proposed, _] = propose_for(&robot).unwrap();
    assert!(proposed.condition < 10.0, "{}", proposed.condition);
    let rows = excite(&robot, &proposed.excitation, 4, &Mismatch::default(), 4).unwrap();
    judged(&robot, false, &identify_robot(&robot, &rows).unwrap());
}
