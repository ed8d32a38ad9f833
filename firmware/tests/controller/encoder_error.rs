//! The known error of an encoder, and the gains of an arm that rests.

use crate::rig::{Rig, START, settings, with};
use fivebar_firmware::MoveKind;
use fivebar_firmware::controller::{Controller, Request};
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::EncoderTable;

/// Of the motor's shaft [rad].
fn error(measured: f64) -> f64 {
    0.05 * measured.sin()
}

/// Both encoders err by up to 6 mrad of the joint, and the settings know it.
fn erring() -> Rig {
    let settings = with(|settings| settings.encoder_tables = [EncoderTable::new(8.0, error); 2]);
    let mut rig = Rig::new(&settings);
    rig.bench.encoder_error = error;
    rig.controller = Controller::new(&settings.check().unwrap());
    rig.run(1);
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig
}

/// How far the angles are off [rad].
fn off(rig: &Rig) -> f64 {
    let pairs = rig
        .controller
        .status()
        .angle
        .into_iter()
        .zip(rig.bench.theta);
    let off = pairs.map(|(shown, true_angle)| (f64::from(shown) - true_angle).abs());
    off.fold(0.0, f64::max)
}

#[test]
fn a_known_error_of_the_encoders_is_corrected_along_a_move() {
    let mut rig = erring();
    rig.controller.request(Request::Arm).unwrap();
    rig.run(30);
    let to = [1.8, 1.3];
    rig.push(1, MoveKind::Joint { to, speed: 0.1 }).unwrap();
    let mut worst = 0.0_f64;
    while rig.controller.state() != State::Armed || !rig.planner.is_empty() {
        rig.tick();
        worst = worst.max(off(&rig));
    }
    assert!(
        (rig.bench.theta[0] - 1.8).abs() < 1e-3,
        "{:?}",
        rig.bench.theta
    );
    assert!(worst < 5e-4, "{worst} rad");
}

#[test]
fn a_known_error_of_the_encoders_is_corrected_while_the_arm_is_moved_by_hand() {
    let mut rig = erring();
    rig.bench.push = [0.03, -0.03];
    let mut worst = 0.0_f64;
    for _ in 0..4000 {
        rig.tick();
        worst = worst.max(off(&rig));
        if (rig.bench.theta[0] - f64::from(START[0])).abs() > 0.5 {
            break;
        }
    }
    assert!(
        (rig.bench.theta[0] - f64::from(START[0])).abs() > 0.3,
        "{:?}",
        rig.bench.theta
    );
    assert!(worst < 5e-4, "{worst} rad");
}

#[test]
fn an_arm_at_rest_answers_the_encoders_noise_with_less_torque() {
    let mut rig = Rig::armed(&settings());
    let mut change = |ticks: u32| {
        let mut sum = 0.0_f64;
        for tick in 0..ticks {
            rig.bench.extra_counts = [(tick % 2) as i32; 2];
            let before = rig.controller.status().torque;
            rig.tick();
            let torque = rig.controller.status().torque;
            sum += f64::from((torque[0] - before[0]).abs() + (torque[1] - before[1]).abs());
        }
        sum / f64::from(ticks)
    };
    let (early, _, late) = (change(500), change(3000), change(500));
    assert!(early > 0.0 && late < 0.2 * early, "{late} of {early} N·m");
}
