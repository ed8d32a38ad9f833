//! Homing to the encoders' index pulses after the switches.

use crate::rig::{OFF, Rig, with};
use fivebar_firmware::Settings;
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::{Field, HomingMethod, HomingSettings, SettingsError};
use std::f64::consts::TAU;

/// The angle of a joint from one pulse to the next [rad].
const TURN: f64 = TAU / 8.0;

fn with_index() -> Settings {
    with(|s| s.home_reference.method = HomingMethod::Index)
}

/// An arm whose switches close by these shares of an encoder's turn behind the pulses.
fn rig(behind: [f64; 2]) -> Rig {
    let mut rig = Rig::new(&with_index());
    rig.bench.switch_behind = behind.map(|share| share * TURN);
    rig
}

fn home(rig: &mut Rig) {
    rig.controller.request(Request::Home).unwrap();
    for _ in 0..150_000 {
        if rig.controller.state() != State::Homing {
            return;
        }
        rig.tick();
    }
    panic!("still homing");
}

/// The search has ended with this fault, and nothing moves.
fn fails(rig: &mut Rig, fault: Fault, number: u8) {
    let status = rig.controller.status();
    assert_eq!((status.fault, fault.number()), (Some(fault), number));
    assert!(!status.homed);
    assert_eq!(rig.run(1), OFF);
    rig.controller.request(Request::ClearFault).unwrap();
    assert_eq!(rig.run(1), OFF);
}

/// The counts less those of the believed angles, of both joints [counts]. Not whole: the counts at the home
/// angles are.
fn origins(rig: &Rig) -> [f64; 2] {
    let status = rig.controller.status();
    let sample = rig.bench.sense();
    [0, 1].map(|joint| {
        let per_count = TURN / 8192.0;
        f64::from(sample.counts[joint]) - f64::from(status.angle[joint]) / per_count
    })
}

#[test]
fn the_angles_are_those_of_the_pulses_to_a_count_wherever_the_switches_close() {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        f64::from(state >> 16) / 65_536.0
    };
    let mut first = None;
    let mut farthest = 0.0_f64;
    for _ in 0..12 {
        // Half a turn behind the pulse, and up to 0.43 turns more or less.
        let behind = [0, 1].map(|_| 0.5 + 0.86 * (random() - 0.5));
        let mut rig = rig(behind);
        home(&mut rig);
        let status = rig.controller.status();
        assert!(status.homed, "{behind:?}: {:?}", rig.controller.fault());
        let found = origins(&rig);
        let first = *first.get_or_insert(found);
        for joint in 0..2 {
            // The angle is a filtered one, and the joint comes to rest still: not by half a count.
            let off = (found[joint] - first[joint]).abs();
            assert!(off < 0.5, "{off} counts, {behind:?}");
            farthest = farthest.max((behind[joint] - 0.5).abs());
            let true_off = f64::from(status.angle[joint]) - rig.bench.theta[joint];
            assert!(true_off.abs() < TURN / 8192.0, "{true_off} rad");
        }
    }
    assert!(farthest > 0.35, "{farthest}");
}

#[test]
fn a_switch_near_a_pulse_is_refused_and_never_gives_the_wrong_turn() {
    for share in [
        -0.04, -0.001, 0.0, 0.001, 0.02, 0.055, 0.945, 0.999, 1.0, 1.02,
    ] {
        let mut rig = rig([0.5, share]);
        home(&mut rig);
        fails(&mut rig, Fault::IndexAmbiguous, 21);
    }
}

#[test]
fn an_encoder_without_pulses_is_a_fault_within_a_turn_and_a_sixteenth() {
    let mut rig = rig([0.5; 2]);
    rig.bench.no_index = true;
    home(&mut rig);
    fails(&mut rig, Fault::IndexNotFound, 20);
    let switch = f64::from(with_index().axes[0].home_angle) + 0.5 * TURN;
    let gone = switch - rig.bench.theta[0];
    assert!(gone < 1.08 * TURN, "{gone} rad");
}

#[test]
fn a_pulse_that_would_be_missed_at_the_creeping_speed_is_refused_by_name() {
    let method = SettingsError::Field(Field::HomingMethod);
    let fastest = HomingSettings::fastest_to_index(8.0 * 8192.0, 10_000.0);
    // A count in four ticks, at an eighth of the speed.
    let counts = f64::from(fastest) / 8.0 * 8.0 * 8192.0 / TAU;
    assert!((counts - 2500.0).abs() < 1e-2, "{counts} counts/s");
    let mut settings = with_index();
    settings.homing.speed = fastest;
    settings.check().unwrap();
    settings.homing.speed = 1.001 * fastest;
    assert_eq!(settings.check().unwrap_err(), method);
    settings.home_reference.method = HomingMethod::Switch;
    settings.check().unwrap();
    let mut settings = with_index();
    settings.axes[1].index_counts = 0;
    assert_eq!(settings.check().unwrap_err(), method);
}
