//! Identification from simulated logs, and logs that are refused.

use crate::identification::numbers;
use fivebar_design::Noise;
use fivebar_design::identification::{
    BASE_NAMES, Excitation, Identification, IdentificationError, Log, Observed, base_parameters,
    identify, standard_parameters,
};
use fivebar_files::robot::Robot;
use fivebar_kinematics::dynamics::{Arm, Link};
use fivebar_kinematics::five_bar::{Joint, Side, WorkingMode};
use nalgebra::Vector2;
use serde_json::Value;
use std::f64::consts::TAU;

const RATE: f64 = 1e4;
pub(crate) const MODE: WorkingMode = WorkingMode::new(Side::Right, Side::Left);

/// An upright or level benchtop arm as it is, heavier than drawn, and its excitation.
pub(crate) struct Setup {
    pub(crate) arm: Arm<f64>,
    pub(crate) base: Vec<f64>,
    pub(crate) excitation: Excitation,
}

pub(crate) fn setup(upright: bool, which: usize) -> Setup {
    let robot = Robot::load("benchtop").unwrap();
    let drawn = robot.arm().unwrap();
    let links = drawn.links().map(|link| Link {
        mass: 1.1 * link.mass,
        inertia: 1.1 * link.inertia,
        ..link
    });
    let gravity = if upright {
        Vector2::new(0.0, -9.81)
    } else {
        Vector2::zeros()
    };
    let arm = Arm::new(robot.geometry, links, 0.05, gravity, drawn.rotor_inertia()).unwrap();
    let base = base_parameters(robot.geometry.lengths(), &standard_parameters(&arm));
    let text = if upright {
        include_str!("../../data/excitation_gravity.json")
    } else {
        include_str!("../../data/excitation_level.json")
    };
    let file: Value = serde_json::from_str(text).unwrap();
    let coefficients = numbers(&file["x"][which]).try_into().unwrap();
    let period = file["period_s"].as_f64().unwrap();
    Setup {
        arm,
        base: base[..if upright { 11 } else { 7 }].to_vec(),
        excitation: Excitation {
            period,
            coefficients,
        },
    }
}

pub(crate) fn observed(arm: &Arm<f64>) -> Observed<'_> {
    Observed {
        geometry: arm.geometry(),
        assembly: Side::Left,
        mode: MODE,
        gravity: arm.gravity(),
        torque_per_ampere: [8.0 * 0.0234; 2],
        current_limit: [4.0; 2],
        tick_rate: RATE,
    }
}

pub(crate) const VISCOUS: [f64; 2] = [1.95e-3, 1.6e-3];
pub(crate) const COULOMB: [f64; 2] = [11.7e-3, 9e-3];

/// A log of the excitation: the torque of each tick by Kane's equations in its middle, with
/// friction, an offset of 4 mA, and noise of the current sensors and encoders of this share.
pub(crate) fn log(setup: &Setup, periods: f64, noisy: f64) -> Log {
    let mut noise = Noise::new(5);
    let mut log = Log::default();
    let geometry = setup.arm.geometry();
    for tick in 0..(periods * setup.excitation.period * RATE) as u32 {
        let time = f64::from(tick) / RATE;
        let [q, ..] = setup.excitation.at(time);
        let [middle, omega, alpha] = setup.excitation.at(time - 0.5 / RATE);
        let pose = geometry.forward(middle[0], middle[1], Side::Left).unwrap();
        let velocities = geometry
            .forward_velocities(&pose, omega[0], omega[1])
            .unwrap();
        let accelerations = geometry
            .forward_accelerations(&pose, &velocities, alpha[0], alpha[1])
            .unwrap();
        let torque =
            setup
                .arm
                .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros());
        let torque = torque.unwrap();
        let current = |joint: Joint, noise: &mut Noise| {
            let x = omega[joint] / 0.02;
            let friction =
                VISCOUS[joint] * omega[joint] + COULOMB[joint] * x / (1.0 + x * x).sqrt();
            (torque[joint] + friction) / (8.0 * 0.0234) + 4e-3 + noisy * 8e-3 * noise.normal()
        };
        let step = TAU / 131_072.0;
        let angle = |q: f64| {
            if noisy > 0.0 {
                ((q / step).floor() + 0.5) * step
            } else {
                q
            }
        };
        log.times.push(time);
        log.angles.push(q.map(angle));
        log.currents
            .push(Joint::ALL.map(|joint| current(joint, &mut noise)));
    }
    log
}

#[test]
fn heavier_arms_with_noisy_sensors_are_identified() {
    for upright in [false, true] {
        let setup = setup(upright, 0);
        let found = identify(&log(&setup, 10.0, 1.0), &observed(&setup.arm)).unwrap();
        println!("{found:?}");
        for (index, (own, wanted)) in found.base.iter().zip(&setup.base).enumerate() {
            println!(
                "{} {own:.6e} {wanted:.6e} sd {:.1e}",
                BASE_NAMES[index], found.base_sd[index]
            );
        }
        let condition = if upright { 20.0..45.0 } else { 5.0..9.0 };
        assert!(condition.contains(&found.condition), "{}", found.condition);
        let great = [0, 1, 2, 4, 7, 9];
        for (index, (own, wanted)) in found.base.iter().zip(&setup.base).enumerate() {
            let error = (own - wanted).abs();
            let bound = if great.contains(&index) {
                2e-3 * wanted.abs()
            } else {
                6.0 * found.base_sd[index] + 1e-6
            };
            assert!(
                error < bound,
                "{}: {own:e} for {wanted:e}",
                BASE_NAMES[index]
            );
        }
        for joint in 0..2 {
            assert!(
                (found.viscous[joint] / VISCOUS[joint] - 1.0).abs() < 0.01,
                "{:?}",
                found.viscous
            );
            assert!(
                (found.coulomb[joint] / COULOMB[joint] - 1.0).abs() < 0.01,
                "{:?}",
                found.coulomb
            );
            let offset = 4e-3 * 8.0 * 0.0234;
            assert!((found.offset[joint] - offset).abs() < 5.0 * found.offset_sd[joint] + 2e-5);
            assert!(found.residual_rms[joint] < 3e-4, "{:?}", found.residual_rms);
        }
    }
}

#[test]
fn bad_logs_are_refused_with_their_reason() {
    let setup = setup(false, 1);
    let observed = observed(&setup.arm);
    let whole = log(&setup, 2.0, 1.0);
    assert!(identify(&whole, &observed).is_ok());
    let refusal = |change: &dyn Fn(&mut Log)| {
        let mut log = whole.clone();
        change(&mut log);
        identify(&log, &observed).unwrap_err()
    };
    let swap = |rows: &mut Vec<[f64; 2]>| rows.iter_mut().for_each(|row| row.swap(0, 1));
    assert_eq!(
        refusal(&|log| log.angles.iter_mut().for_each(|row| row[1] = 0.8)),
        IdentificationError::Still(Joint::Joint4, 0.0)
    );
    let saturated = refusal(&|log| {
        for row in &mut log.currents {
            row[0] = (8.0 * row[0]).clamp(-4.0, 4.0);
        }
    });
    assert!(
        matches!(saturated, IdentificationError::Saturated(Joint::Joint1, _)),
        "{saturated}"
    );
    let gap = refusal(&|log| {
        log.times.drain(700..720);
        log.angles.drain(700..720);
        log.currents.drain(700..720);
    });
    assert!(matches!(gap, IdentificationError::Gap(700, _)), "{gap}");
    let rate = refusal(&|log| log.times.iter_mut().for_each(|time| *time *= 2.0));
    assert!(matches!(rate, IdentificationError::Rate(..)), "{rate}");
    let jump = refusal(&|log| log.angles[900..].iter_mut().for_each(|row| row[0] += 1.0));
    assert_eq!(jump, IdentificationError::Jump(Joint::Joint1, 900));
    assert_eq!(
        refusal(&|log| swap(&mut log.angles)),
        IdentificationError::SwappedAngles
    );
    assert_eq!(
        refusal(&|log| {
            swap(&mut log.angles);
            swap(&mut log.currents);
        }),
        IdentificationError::SwappedAngles
    );
    assert_eq!(
        refusal(&|log| swap(&mut log.currents)),
        IdentificationError::SwappedCurrents
    );
    let reversed = refusal(&|log| {
        log.currents
            .iter_mut()
            .for_each(|row| *row = [-row[0], -row[1]]);
    });
    assert_eq!(reversed, IdentificationError::Reversed);
    let one = refusal(&|log| log.currents.iter_mut().for_each(|row| row[1] = -row[1]));
    assert!(
        matches!(
            one,
            IdentificationError::Reversed | IdentificationError::Unexplained(..)
        ),
        "{one}"
    );
    let short = refusal(&|log| log.times.truncate(3000));
    assert!(matches!(short, IdentificationError::TooShort(_)), "{short}");
    let nan = refusal(&|log| log.currents[41][0] = f64::NAN);
    assert_eq!(nan, IdentificationError::NotFinite(42));
    // Whole turns in the angles are none of its business.
    let mut turned = whole.clone();
    turned.angles[5000..]
        .iter_mut()
        .for_each(|row| row[0] += TAU);
    let [plain, turned] = [&whole, &turned].map(|log| identify(log, &observed).unwrap());
    assert!((plain.base[0] / turned.base[0] - 1.0).abs() < 1e-6);
}

#[test]
fn a_late_current_shows_in_the_coupler() {
    // The current of a row acts before its tick. Without that half tick J3* is off by 12 %.
    let setup = setup(false, 0);
    let mut early = log(&setup, 4.0, 0.0);
    let sound = identify(&early, &observed(&setup.arm)).unwrap();
    early.currents.remove(0);
    early.currents.push([0.0; 2]);
    let shifted = identify(&early, &observed(&setup.arm)).unwrap();
    let error = |found: &Identification| (found.base[3] / setup.base[3] - 1.0).abs();
    assert!(error(&sound) < 0.01, "{}", error(&sound));
    assert!(error(&shifted) > 0.05, "{}", error(&shifted));
}
