//! Each joint controlled by itself, without the arm's model.

use crate::rig::{Rig, START, settings};
use fivebar_firmware::MoveKind;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::Settings;

fn independent() -> Settings {
    let mut settings = settings();
    settings.control.computed_torque = false;
    settings
}

#[test]
fn independent_joints_hold_against_a_push_on_either() {
    for push in [[0.1, 0.0], [0.0, 0.1], [-0.1, 0.05]] {
        let mut rig = Rig::armed(&independent());
        rig.bench.push = push;
        rig.run(3000);
        assert_eq!(rig.controller.state(), State::Armed);
        for (joint, start) in START.into_iter().enumerate() {
            // The integral brings them back.
            let turned = rig.bench.theta[joint] - f64::from(start);
            assert!(turned.abs() < 2e-4, "{turned} rad");
            assert!(rig.bench.omega[joint].abs() < 0.1, "at rest");
        }
    }
}

#[test]
fn independent_joints_follow_a_slow_line_within_a_tenth_of_a_millimetre() {
    let mut rig = Rig::armed(&independent());
    let [x, y] = rig.tool_position();
    let to = [x - 0.03, y + 0.02];
    rig.push(7, MoveKind::Line { to, feed: 0.05 }).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..12_000 {
        rig.tick();
        let [rx, ry] = rig.controller.status().reference.expect("powered");
        let [tx, ty] = rig.bench.tool();
        worst = worst.max((tx - f64::from(rx)).hypot(ty - f64::from(ry)));
    }
    assert_eq!(rig.controller.state(), State::Armed);
    assert!(worst < 1e-4, "{worst} m");
}

/// Friction is compensated ahead of the loop, so that little is left without an integral, too.
#[test]
fn computed_torque_without_an_integral_follows_a_line_within_20_micrometres() {
    let mut settings = settings();
    settings.control.integral_rate = 0.0;
    let mut rig = Rig::armed(&settings);
    let [x, y] = rig.tool_position();
    let to = [x - 0.03, y + 0.02];
    rig.push(7, MoveKind::Line { to, feed: 0.1 }).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..3000 {
        rig.tick();
        let [rx, ry] = rig.controller.status().reference.expect("powered");
        let [tx, ty] = rig.bench.tool();
        worst = worst.max((tx - f64::from(rx)).hypot(ty - f64::from(ry)));
    }
    assert_eq!(rig.controller.state(), State::Running);
    assert!(worst < 2e-5, "{worst} m");
}
