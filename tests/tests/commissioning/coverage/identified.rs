//! Masses and friction from logs with noisy currents and encoders of whole counts.

use super::{Case, Tally};
use crate::logs::{COULOMB, Setup, VISCOUS, observed, setup};
use fivebar_design::Noise;
use fivebar_design::identification::{Identification, Log, Observed, identify};
use fivebar_kinematics::five_bar::{Joint, Side};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Rate of the logs [Hz].
const RATE: f64 = 2e3;
/// Torque per ampere [N·m/A].
const PER_AMPERE: f64 = 8.0 * 0.0234;
/// Offset of the current sensors [A].
const OFFSET: f64 = 4e-3;
/// Noise of the current sensors [A].
const NOISE: f64 = 8e-3;

/// A log without noise: θ of each tick and the current before it.
fn exact(setup: &Setup, periods: f64) -> Log {
    let mut log = Log::default();
    let geometry = setup.arm.geometry();
    for tick in 0..(periods * setup.excitation.period * RATE) as u32 {
        let time = f64::from(tick) / RATE;
        let [q, ..] = setup.excitation.at(time);
        let [middle, omega, alpha] = setup.excitation.at(time - 0.5 / RATE);
        let pose = geometry.forward(middle[0], middle[1], Side::Left).unwrap();
        let rates = geometry
            .forward_velocities(&pose, omega[0], omega[1])
            .unwrap();
        let accelerations = geometry.forward_accelerations(&pose, &rates, alpha[0], alpha[1]);
        let torque =
            setup
                .arm
                .inverse_dynamics(&pose, &rates, &accelerations.unwrap(), Vector2::zeros());
        let torque = torque.unwrap();
        log.times.push(time);
        log.angles.push(q);
        log.currents.push(Joint::ALL.map(|joint| {
            let x = omega[joint] / 0.02;
            let friction =
                VISCOUS[joint] * omega[joint] + COULOMB[joint] * x / (1.0 + x * x).sqrt();
            (torque[joint] + friction) / PER_AMPERE + OFFSET
        }));
    }
    log
}

/// The log with the errors of a case: three rows of wrong currents, or other noise.
fn noisy(exact: &Log, case: Case, noise: &mut Noise) -> Log {
    let mut log = exact.clone();
    let step = TAU / 131_072.0;
    let phase = [noise.uniform(), noise.uniform()];
    for (angles, currents) in log.angles.iter_mut().zip(&mut log.currents) {
        for joint in 0..2 {
            let count = (angles[joint] / step + phase[joint]).floor() + 0.5;
            angles[joint] = (count - phase[joint]) * step;
            currents[joint] += NOISE * case.error(noise);
        }
    }
    if case == Case::Wrong {
        for _ in 0..3 {
            let row = (noise.uniform() * log.currents.len() as f64) as usize;
            log.currents[row][(2.0 * noise.uniform()) as usize] += 2.0;
        }
    }
    log
}

pub(super) fn tally(upright: bool, case: Case, repetitions: u32) -> Tally {
    let setup = setup(upright, 0);
    let exact = exact(&setup, 4.0);
    let observed = Observed {
        tick_rate: RATE,
        ..observed(&setup.arm)
    };
    let mut noise = Noise::new(49);
    let mut tally = Tally::default();
    for _ in 0..repetitions {
        let found = identify(&noisy(&exact, case, &mut noise), &observed).unwrap();
        tally.accepted += 1;
        for [value, sd, wanted] in values(&found, &setup) {
            tally.interval(value - wanted, sd, found.coverage_factor);
        }
    }
    tally
}

/// Each value, its deviation and the true one.
fn values(found: &Identification, setup: &Setup) -> Vec<[f64; 3]> {
    let base = (found.base.iter().zip(&found.base_sd)).zip(&setup.base);
    let mut values: Vec<_> = base
        .map(|((value, sd), wanted)| [*value, *sd, *wanted])
        .collect();
    for joint in 0..2 {
        values.push([
            found.viscous[joint],
            found.viscous_sd[joint],
            VISCOUS[joint],
        ]);
        values.push([
            found.coulomb[joint],
            found.coulomb_sd[joint],
            COULOMB[joint],
        ]);
        values.push([
            found.offset[joint],
            found.offset_sd[joint],
            OFFSET * PER_AMPERE,
        ]);
    }
    values
}

#[test]
fn the_intervals_of_an_identification_hold_95_percent_in_every_case() {
    for case in Case::ALL {
        let tally = tally(false, case, 8);
        println!(
            "{case:?}: {:.3} {:.2} {tally:?}",
            tally.share(),
            tally.rms()
        );
        // The thirteen values of one log are worth some six independent ones.
        tally.assert_covers("log, level", case, 6.0);
    }
}

#[test]
fn three_wrong_currents_cost_an_identification_their_rows_alone() {
    let setup = setup(false, 0);
    let exact = exact(&setup, 4.0);
    let observed = Observed {
        tick_rate: RATE,
        ..observed(&setup.arm)
    };
    let [sound, spoilt] = [Case::Clean, Case::Wrong].map(|case| {
        let log = noisy(&exact, case, &mut Noise::new(51));
        identify(&log, &observed).unwrap()
    });
    assert_eq!(sound.left_out, [0.0; 2]);
    let left_out: f64 = spoilt.left_out.iter().sum();
    assert!(left_out > 0.0 && left_out < 0.1, "{spoilt:?}");
    let pairs = values(&spoilt, &setup)
        .into_iter()
        .zip(values(&sound, &setup));
    for ([value, sd, wanted], [_, as_sound, _]) in pairs {
        assert!(
            (value - wanted).abs() < 4.0 * sd,
            "{value} ± {sd}: {wanted}"
        );
        assert!((sd / as_sound - 1.0).abs() < 0.3, "{sd} for {as_sound}");
    }
}
