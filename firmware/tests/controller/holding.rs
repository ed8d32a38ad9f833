//! The armed arm holds its position against a force.

use crate::rig::{Rig, START, settings, with};
use fivebar_firmware::safety::{Fault, State};

#[test]
fn holds_still_when_armed() {
    let mut rig = Rig::armed(&settings());
    rig.run(3000);
    assert_eq!(rig.controller.status().state, State::Armed);
    for (theta, start) in rig.bench.theta.into_iter().zip(START) {
        assert!(
            (theta - f64::from(start)).abs() < 2e-4,
            "{theta} for {start}"
        );
    }
}

#[test]
fn holds_position_under_external_torque() {
    let mut rig = Rig::armed(&settings());
    rig.bench.push = [0.1, -0.05];
    rig.run(10_000);
    let status = rig.controller.status();
    assert_eq!(status.state, State::Armed, "{:?}", rig.controller.fault());
    for (theta, start) in rig.bench.theta.into_iter().zip(START) {
        assert!(
            (theta - f64::from(start)).abs() < 2e-4,
            "{theta} for {start}"
        );
    }
    // The motors hold it: their torque balances the push, less friction.
    let [torque1, torque4] = status.torque;
    assert!((torque1 + 0.1).abs() < 0.012, "{torque1}");
    assert!((torque4 - 0.05).abs() < 0.012, "{torque4}");
}

/// Ticks of the disarm timeout, 60 s.
const ALONE: u32 = 600_000;

/// Runs `rig` without a sign of life until its bridges are off. Returns the number of ticks.
fn ticks_until_off(rig: &mut Rig) -> u32 {
    (1..=ALONE + 10)
        .find(|_| {
            rig.planner.run(&mut rig.controller);
            let command = rig.tick_alone();
            command.enable == [false; 2] && command.brake
        })
        .expect("the bridges are off")
}

/// Switched off within a minute, at most some ticks earlier.
#[track_caller]
fn assert_in_a_minute(ticks: u32) {
    assert!((ALONE - 10..=ALONE).contains(&ticks), "{ticks} ticks");
}

#[test]
fn an_armed_arm_that_its_host_has_left_is_switched_off_after_a_minute() {
    let mut rig = Rig::armed(&settings());
    assert_eq!(rig.controller.state(), State::Armed);
    assert_in_a_minute(ticks_until_off(&mut rig));
    assert_eq!(rig.controller.state(), State::Fault);
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
}

#[test]
fn an_arm_left_alone_is_switched_off_after_its_disarm_timeout() {
    let mut rig = Rig::armed(&with(|s| s.advanced.disarm_timeout = 2.0));
    let ticks = ticks_until_off(&mut rig);
    assert!((20_000 - 10..=20_000).contains(&ticks), "{ticks} ticks");
}

#[test]
fn an_arm_that_is_held_under_a_fault_is_switched_off_after_a_minute() {
    let mut rig = Rig::armed(&settings());
    rig.controller.latch_fault(Fault::QueueUnderrun);
    rig.tick_alone();
    assert_in_a_minute(ticks_until_off(&mut rig));
    // The fault that holds no longer holds: the one that switched the bridges off is shown.
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
}

#[test]
fn an_armed_arm_whose_host_gives_signs_of_life_stays_armed() {
    let mut rig = Rig::armed(&settings());
    for tick in 0..2 * ALONE {
        // One sign of life in 50 s.
        if tick % 500_000 == 0 {
            rig.controller.feed_host_timeout();
        }
        rig.tick_alone();
    }
    assert_eq!(rig.controller.state(), State::Armed);
}
