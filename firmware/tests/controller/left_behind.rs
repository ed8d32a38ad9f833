//! What one motion, fault or excitation leaves behind for the next: nothing but what it says.

use crate::rig::{Bench, Rig, START, WAKING_TICKS, settings, with};
use fivebar_firmware::controller::{Controller, Request, RequestError};
use fivebar_firmware::safety::{Fault, Limits, State};
use fivebar_firmware::{MoveKind, Settings};

/// On its way along 60 mm at 0.1 m/s.
fn running(rig: &mut Rig) {
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    rig.run(1000);
    assert_eq!(rig.controller.state(), State::Running);
}

/// Settings with which the arm can be pushed away.
fn yielding() -> Settings {
    with(|settings| settings.protection.following_error = 0.9)
}

#[test]
fn a_limited_torque_is_reported_while_it_is_limited_and_not_with_the_bridges_off() {
    for push in [[0.85, 0.0], [0.0, 0.85]] {
        let mut rig = Rig::armed(&yielding());
        assert_eq!(rig.controller.status().limits, Limits::empty());
        rig.bench.push = push;
        rig.run(300);
        let limits = rig.controller.status().limits;
        assert!(limits.contains(Limits::TORQUE), "{push:?}");
        rig.bench.overlay.emergency_stop = true;
        rig.tick();
        assert_eq!(rig.controller.status().limits, Limits::empty());
    }
}

#[test]
fn a_joint_that_could_not_resist_comes_back_without_swinging_far_beyond() {
    for joint in 0..2 {
        let mut rig = Rig::armed(&yielding());
        let start = rig.bench.theta[joint];
        rig.bench.push[joint] = 0.8;
        rig.run(1500);
        rig.bench.push[joint] = 0.0;
        let mut beyond = 0.0_f64;
        for _ in 0..5000 {
            rig.tick();
            beyond = beyond.max(start - rig.bench.theta[joint]);
        }
        assert!(beyond < 0.4, "joint {joint}: {beyond} rad");
    }
}

#[test]
fn an_arm_armed_anew_begins_without_the_load_that_it_held_before() {
    let mut rig = Rig::armed(&settings());
    rig.bench.push = [0.06, -0.04];
    rig.run(3000);
    rig.controller.request(Request::Disarm).unwrap();
    rig.bench.push = [0.0; 2];
    rig.run(10);
    rig.controller.request(Request::Arm).unwrap();
    rig.run(WAKING_TICKS + 1);
    let torque = rig.controller.status().torque;
    assert!(
        torque.iter().all(|torque| torque.abs() < 0.01),
        "{torque:?}"
    );
}

#[test]
fn an_arm_that_is_armed_before_its_first_tick_takes_its_counts_for_no_motion() {
    let settings = settings();
    let mut controller = Controller::new(&settings.check().unwrap());
    controller.request(Request::SetAngles(START)).unwrap();
    controller.request(Request::Arm).unwrap();
    let mut bench = Bench::new(&settings);
    bench.extra_counts = [100_000, -100_000];
    for _ in 0..2 * WAKING_TICKS {
        let command = controller.tick(&bench.sense());
        assert_eq!(controller.fault(), None);
        assert_eq!(command.enable, [true; 2]);
    }
}

#[test]
fn a_fault_that_held_the_arm_is_over_once_it_is_cleared() {
    let mut rig = Rig::armed(&settings());
    running(&mut rig);
    while rig.controller.status().fault.is_none() {
        rig.planner.run(&mut rig.controller);
        rig.tick_alone();
    }
    rig.run(3000);
    for request in [Request::ClearFault, Request::Arm] {
        rig.controller.request(request).unwrap();
    }
    rig.run(WAKING_TICKS + 1);
    running(&mut rig);
    let refused = Err(RequestError::State(State::Running));
    assert_eq!(rig.controller.request(Request::ClearFault), refused);
}

#[test]
fn a_fault_shows_the_measured_current_and_the_torque_that_was_wanted() {
    let mut rig = Rig::armed(&settings());
    rig.bench.current = [0.0, -6.5];
    rig.tick();
    let snapshot = rig.controller.fault().expect("a fault");
    assert_eq!(snapshot.fault, Fault::OverCurrent);
    let ([current1, current4], torque) = (snapshot.current, snapshot.torque);
    assert!(current1.abs() < 0.1 && (current4 + 6.5).abs() < 0.1);
    assert!(
        torque.iter().all(|torque| torque.abs() < 0.05),
        "{torque:?}"
    );
}

#[test]
fn a_request_is_a_sign_of_life() {
    let mut rig = Rig::armed(&settings());
    running(&mut rig);
    for _ in 0..2 {
        // 90 ms of the 100 ms after which a host is silent. An arm that runs ignores the request.
        for _ in 0..900 {
            rig.planner.run(&mut rig.controller);
            rig.tick_alone();
        }
        rig.controller.request(Request::Arm).unwrap();
    }
    assert_eq!(rig.controller.state(), State::Running);
}
