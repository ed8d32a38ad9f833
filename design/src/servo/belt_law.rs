//! The laws of joints behind belts as numbers: found by asking the code that the target runs.

use super::linear::Linear;
use fivebar_kinematics::control::{BeltLaw, BeltState};
use nalgebra::{DMatrix, DVector};

/// States of one joint's law, without its late demands.
const STATES: usize = 6;

/// From the encoders' angles to the demanded torques of joints with these laws, whose torques act on the encoders'
/// angles `late` ticks later than on the joints. `mass_matrix` is that of the model, with the rotors'
/// inertias `rotors` [kg·m²].
pub(super) fn belt_laws(
    laws: &[BeltLaw<f64>],
    mass_matrix: &DMatrix<f64>,
    rotors: &[f64],
    late: usize,
) -> Linear {
    let joints = laws.len();
    let links = mass_matrix - DMatrix::from_diagonal(&DVector::from_column_slice(rotors));
    let nan = || DMatrix::from_element(joints, joints, f64::NAN);
    let inverse = links.try_inverse().unwrap_or_else(nan);
    // Of each joint: its law's, then the demands, the newest first.
    let size = STATES + 1 + late;
    Linear::asked([joints * size, joints, joints], |x, measured| {
        let mut states: Vec<BeltState<f64>> = x.chunks(size).map(state).collect();
        let each = |values: Vec<f64>| DVector::from_vec(values);
        let impulses = each(
            laws.iter()
                .zip(&mut states)
                .zip(measured)
                .map(|((law, state), &angle)| law.correct(state, angle, 0.0))
                .collect(),
        );
        let changes = &inverse * impulses;
        for (state, change) in states.iter_mut().zip(changes.iter()) {
            state.velocity += change;
        }
        let demands: Vec<_> = laws
            .iter()
            .zip(&states)
            .map(|(law, state)| law.demand(state))
            .collect();
        let alpha = each(demands.iter().map(|demand| demand.alpha).collect());
        let beside = each(demands.iter().map(|demand| demand.torque).collect());
        let torque = mass_matrix * alpha + beside;
        let impulses = laws.iter().zip(&states);
        let impulses = each(impulses.map(|(law, state)| law.impulse(state)).collect());
        let changes = &inverse * impulses;
        let mut next = Vec::with_capacity(x.len());
        for (joint, (law, state)) in laws.iter().zip(&mut states).enumerate() {
            let demands = &x[joint * size + STATES..(joint + 1) * size];
            law.advance(state, changes[joint], demands[late]);
            let BeltState {
                rotor_angle,
                rotor_velocity,
                angle,
                velocity,
                load,
                torque: of_drive,
            } = *state;
            next.extend([rotor_angle, rotor_velocity, angle, velocity, load, of_drive]);
            next.push(torque[joint]);
            next.extend(&demands[..late]);
        }
        (next, torque.as_slice().to_vec())
    })
}

fn state(x: &[f64]) -> BeltState<f64> {
    BeltState {
        rotor_angle: x[0],
        rotor_velocity: x[1],
        angle: x[2],
        velocity: x[3],
        load: x[4],
        torque: x[5],
    }
}
