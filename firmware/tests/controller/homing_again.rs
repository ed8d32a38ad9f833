//! Homing an arm whose angles are known already, or lie.

use crate::rig::{Rig, START, settings};
use fivebar_firmware::Settings;
use fivebar_firmware::controller::{Request, RequestError};
use fivebar_firmware::safety::{Fault, State};

fn homed() -> Rig {
    let mut rig = Rig::new(&settings());
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig.run(10);
    rig
}

#[test]
fn an_arm_that_homes_again_starts_where_it_is_and_knows_no_angles_until_it_ends() {
    let mut rig = homed();
    rig.controller.request(Request::Home).unwrap();
    for _ in 0..200 {
        rig.tick();
        assert_eq!(rig.controller.state(), State::Homing);
        assert!(!rig.controller.status().homed);
    }
    rig.controller.request(Request::Disarm).unwrap();
    let arm = rig.controller.request(Request::Arm);
    assert_eq!(arm, Err(RequestError::NotHomed));
    rig.controller.request(Request::Home).unwrap();
    while rig.controller.state() == State::Homing {
        rig.tick();
    }
    assert!(rig.controller.status().homed);
}

#[test]
fn angles_set_twice_are_those_set_last() {
    let mut rig = homed();
    for angles in [START, [2.1, 0.8], START] {
        rig.controller.request(Request::SetAngles(angles)).unwrap();
        for (angle, set) in rig.controller.status().angle.into_iter().zip(angles) {
            assert!((angle - set).abs() < 1e-5, "{angle} for {set}");
        }
    }
}

#[test]
fn angles_of_another_working_mode_are_refused() {
    let mut rig = Rig::new(&settings());
    // The elbow of leg 1 is on the other side.
    let set = rig.controller.request(Request::SetAngles([0.65, 0.9]));
    assert_eq!(set, Err(RequestError::NotOnBranch));
    assert!(!rig.controller.status().homed);
}

#[test]
fn switches_at_angles_of_another_working_mode_are_an_encoder_disagreement() {
    let mut elsewhere: Settings = settings();
    elsewhere.axes[0].home_angle = 0.65;
    elsewhere.axes[1].home_angle = 0.9;
    let mut rig = Rig::new(&elsewhere);
    rig.bench.stuck = Some([false; 2]);
    rig.controller.request(Request::Home).unwrap();
    for (closed, ticks) in [(false, 300), (true, 300), (false, 9000), (true, 300)] {
        rig.bench.stuck = Some([closed; 2]);
        rig.run(ticks);
    }
    let fault = rig.controller.status().fault;
    assert_eq!(fault, Some(Fault::EncoderDisagreement));
    assert!(!rig.controller.status().homed);
    assert_eq!(rig.run(1).enable, [false; 2]);
}

#[test]
fn homing_goes_on_until_both_switches_are_found() {
    for joint in 0..2 {
        let mut rig = Rig::new(&settings());
        rig.controller.request(Request::Home).unwrap();
        for (closed, ticks) in [(false, 300), (true, 300), (false, 3000), (true, 3000)] {
            let mut stuck = [false; 2];
            stuck[joint] = closed;
            rig.bench.stuck = Some(stuck);
            rig.run(ticks);
            assert_eq!(rig.controller.state(), State::Homing);
            assert!(!rig.controller.status().homed);
        }
    }
}

/// The search demands what friction takes, so its loop without an integral is left with little.
#[test]
fn a_search_at_speed_follows_its_reference_closely() {
    let mut rig = Rig::new(&settings());
    rig.controller.request(Request::Home).unwrap();
    rig.run(2500);
    rig.controller.request(Request::EmergencyStop).unwrap();
    let snapshot = rig.controller.fault().unwrap();
    assert_eq!(snapshot.state, State::Homing);
    for (speed, sign) in snapshot.velocity.into_iter().zip([1.0, -1.0]) {
        assert!((speed - sign * 0.7).abs() < 0.05, "{speed} rad/s");
    }
    for error in snapshot.error {
        assert!(error.abs() < 3e-5, "{error} rad");
    }
}
