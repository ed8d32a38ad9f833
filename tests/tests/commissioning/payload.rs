//! The payload alone, from short logs of an arm with known masses.

use crate::logs::{Setup, log, observed, setup};
use fivebar_design::identification::{IdentificationError, Log, Payload, identify_payload};
use fivebar_kinematics::dynamics::Arm;

/// As in the arm of [`setup`].
const TRUTH: f64 = 0.05;

/// The arm of the log with another payload: what the robot file may say [kg].
fn known(setup: &Setup, payload: f64) -> Arm<f64> {
    let arm = &setup.arm;
    let links = *arm.links();
    Arm::new(
        *arm.geometry(),
        links,
        payload,
        arm.gravity(),
        arm.rotor_inertia(),
    )
    .unwrap()
}

fn found(setup: &Setup, periods: f64, noisy: f64, payload: f64) -> Payload {
    let log = log(setup, periods, noisy);
    identify_payload(&log, &observed(&setup.arm), &known(setup, payload)).unwrap()
}

#[test]
fn one_second_finds_a_payload_to_a_gram() {
    for upright in [false, true] {
        let setup = setup(upright, 0);
        let quiet = found(&setup, 0.8, 0.0, 0.0);
        assert!((quiet.mass - TRUTH).abs() < 1e-4, "{upright}: {quiet:?}");
        let noisy = found(&setup, 0.8, 1.0, 0.0);
        assert!((noisy.mass - TRUTH).abs() < 1e-3, "{upright}: {noisy:?}");
        assert!((noisy.mass - TRUTH).abs() < 4.0 * noisy.sd + 1e-4 && noisy.sd < 1e-3);
        // What the file says of the payload does not matter.
        let other = found(&setup, 0.8, 1.0, 0.2);
        assert!((other.mass - noisy.mass).abs() < 1e-9);
    }
}

#[test]
fn wrong_logs_and_a_payload_below_nothing_are_refused() {
    let setup = setup(false, 0);
    let arm = &setup.arm;
    let heavy = arm.links().map(|link| fivebar_kinematics::dynamics::Link {
        mass: 2.0 * link.mass,
        inertia: 2.0 * link.inertia,
        ..link
    });
    let heavy = Arm::new(
        *arm.geometry(),
        heavy,
        0.0,
        arm.gravity(),
        arm.rotor_inertia(),
    )
    .unwrap();
    let sound = log(&setup, 0.8, 1.0);
    let refused =
        |log: &Log, arm: &Arm<f64>| identify_payload(log, &observed(arm), arm).unwrap_err();
    let light = refused(&sound, &heavy);
    assert!(
        matches!(light, IdentificationError::NoPayload(mass, _) if mass < 0.0),
        "{light:?}"
    );
    let mut swapped = sound.clone();
    swapped.currents.iter_mut().for_each(|row| row.swap(0, 1));
    assert!(matches!(
        refused(&swapped, arm),
        IdentificationError::NoPayload(..) | IdentificationError::Unexplained(..)
    ));
    let mut still = sound.clone();
    still.angles.iter_mut().for_each(|row| *row = [2.4, 0.8]);
    assert!(matches!(
        refused(&still, arm),
        IdentificationError::Still(..)
    ));
    let mut short = sound;
    short.times.truncate(100);
    short.angles.truncate(100);
    short.currents.truncate(100);
    assert!(matches!(
        refused(&short, arm),
        IdentificationError::TooShort(_)
    ));
}
