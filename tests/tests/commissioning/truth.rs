//! What the arms of the simulation really have.

use fivebar_design::identification::{base_parameters, standard_parameters};
use fivebar_files::robot::Robot;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_plant::Mismatch;

/// The base parameters of a robot's arm with a mismatch.
pub(crate) fn base_with(robot: &Robot, mismatch: &Mismatch) -> Vec<f64> {
    let drawn = robot.arm().unwrap();
    let heavier = 1.0 + mismatch.link_mass;
    let links = drawn.links().map(|link| Link {
        mass: heavier * link.mass,
        inertia: heavier * link.inertia,
        ..link
    });
    let payload = drawn.payload() + mismatch.payload;
    let rotors = drawn.rotor_inertia();
    let arm = Arm::new(robot.geometry, links, payload, drawn.gravity(), rotors).unwrap();
    base_parameters(robot.geometry.lengths(), &standard_parameters(&arm)).to_vec()
}
