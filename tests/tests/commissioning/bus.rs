//! Identification of simulated arms whose drives are on a bus.

use crate::truth::base_with;
use fivebar_files::robot::{BuiltIn, CanMotor, Draft, Motors, Robot};
use fivebar_plant::Mismatch;
use fivebar_report::study::identification::{identify_robot, propose_for};
use fivebar_sim::excitation::excite;

const MISMATCH: Mismatch = Mismatch {
    link_mass: 0.12,
    friction: 0.25,
    payload: 0.015,
    ..Mismatch::NONE
};

const LIGHT: Mismatch = Mismatch {
    link_mass: -0.07,
    friction: -0.3,
    payload: 0.04,
    ..Mismatch::NONE
};

/// The leg with either protocol, and an arm of `fivebar new` with ODrives, on a level table.
fn robots() -> [Robot; 3] {
    let leg = BuiltIn::find("leg").unwrap().text;
    let mit = leg.replace(
        "protocol = \"odrive\"",
        "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0",
    );
    let mut draft = Draft::new("new");
    draft.motors = Motors::CanDrives(CanMotor::TYPICAL);
    [leg.to_owned(), mit, draft.text()].map(|text| Robot::parse("arm.toml", &text).unwrap())
}

/// By how much of its 95 % interval each base parameter and each friction is off.
fn off(robot: &Robot, which: usize, mismatch: &Mismatch) -> Vec<f64> {
    let proposed = propose_for(robot).unwrap();
    let rows = excite(robot, &proposed[which].excitation, 10, mismatch, 5).unwrap();
    let found = identify_robot(robot, &rows).unwrap();
    let actuators = robot.actuators.unwrap();
    let stronger = 1.0 + mismatch.friction;
    let viscous = actuators.map(|actuator| stronger * actuator.viscous_friction);
    let coulomb = actuators.map(|actuator| stronger * actuator.coulomb_friction);
    let truth = base_with(robot, mismatch);
    for index in [0, 2, 4] {
        let error = (found.base[index] / truth[index] - 1.0).abs();
        assert!(error < 0.007, "{}, {index}: {error}", robot.name);
    }
    for joint in 0..2 {
        let found = [found.viscous[joint], found.coulomb[joint]];
        for (own, wanted) in found.into_iter().zip([viscous[joint], coulomb[joint]]) {
            let error = (own - wanted).abs();
            assert!(error <= 0.015 * wanted.max(6e-3), "{own} for {wanted}");
        }
    }
    let pairs = [
        (&found.base[..], &found.base_sd[..], &truth[..]),
        (&found.viscous, &found.viscous_sd, &viscous),
        (&found.coulomb, &found.coulomb_sd, &coulomb),
    ];
    let mut off = Vec::new();
    for (own, sd, wanted) in pairs {
        for ((own, sd), wanted) in own.iter().zip(sd).zip(wanted) {
            off.push((own - wanted).abs() / (sd * found.coverage_factor));
        }
    }
    off
}

/// Of two plants, with two excitations each, about as many as stated.
#[test]
fn masses_and_friction_lie_within_their_intervals() {
    let mut all = Vec::new();
    for robot in robots() {
        for (which, mismatch) in [(0, &MISMATCH), (1, &MISMATCH), (0, &LIGHT), (1, &LIGHT)] {
            let off = off(&robot, which, mismatch);
            all.extend(off);
        }
    }
    let within = all.iter().filter(|off| **off < 1.0).count();
    assert!(100 * within >= 92 * all.len(), "{within} of {}", all.len());
    assert!(all.iter().all(|off| *off < 2.0), "{all:.2?}");
}
