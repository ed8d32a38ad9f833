//! The armed arm holds its position against a force.

mod rig;

use fivebar_firmware::safety::State;
use rig::{Rig, START, settings};

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
