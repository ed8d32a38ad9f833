//! Counts that are lost show where the joints pass their index pulses and home switches.

use crate::rig::{Rig, settings, with};
use fivebar_firmware::controller::Request;
use fivebar_firmware::safety::{Fault, Response, State};
use fivebar_firmware::settings::HomingMethod;
use fivebar_firmware::{MoveKind, Settings};
use fivebar_kinematics::five_bar::{Geometry, Side};
use std::f64::consts::TAU;

/// From one index pulse to the next [rad].
const TURN: f64 = TAU / 8.0;

/// Homed by this method, and armed where it was homed.
fn homed(settings: &Settings) -> Rig {
    let mut rig = Rig::new(settings);
    if settings.home_reference.method == HomingMethod::Index {
        rig.bench.switch_behind = [0.5 * TURN; 2];
    }
    rig.controller.request(Request::Home).unwrap();
    for _ in 0..150_000 {
        if rig.controller.state() != State::Homing {
            break;
        }
        rig.tick();
    }
    assert!(
        rig.controller.status().homed,
        "{:?}",
        rig.controller.fault()
    );
    rig.run(2000);
    rig.controller.request(Request::Arm).unwrap();
    rig.run(100);
    rig
}

fn with_index() -> Settings {
    with(|s| s.home_reference.method = HomingMethod::Index)
}

/// Moves twice to where each joint has turned by more than a turn of its encoder, and back; returns the fault that ends it. `change` may change the bench
/// before each tick.
fn move_to_and_fro(rig: &mut Rig, mut change: impl FnMut(u32, &mut Rig)) -> Option<Fault> {
    let home = rig.tool_position();
    let geometry = Geometry::new(settings().lengths).unwrap();
    let far = geometry.forward(1.9, 1.2, Side::Left).unwrap().c;
    for leg in 0..4 {
        let to = if leg % 2 == 0 { [far.x, far.y] } else { home };
        rig.push(leg, MoveKind::Line { to, feed: 0.1 }).unwrap();
    }
    for tick in 0..60_000 {
        change(tick, rig);
        rig.tick();
        if rig.controller.state() == State::Fault {
            break;
        }
    }
    rig.controller.status().fault
}

#[test]
fn an_arm_that_loses_nothing_passes_its_pulses_and_switches() {
    for settings in [settings(), with_index()] {
        let mut rig = homed(&settings);
        let mut seen = 0;
        let fault = move_to_and_fro(&mut rig, |_, rig| {
            seen += usize::from(rig.bench.sense().index[0]);
        });
        assert_eq!((fault, rig.controller.state()), (None, State::Armed));
        assert!(seen > 2, "{seen} ticks with a pulse");
    }
}

#[test]
fn counts_that_are_lost_are_a_fault_at_the_next_pulses() {
    for joint in 0..2 {
        let mut rig = homed(&with_index());
        // 100 of 8192 counts, one in ten ticks.
        let fault = move_to_and_fro(&mut rig, |tick, rig| {
            if (3000..4000).contains(&tick) && tick % 10 == 0 {
                rig.bench.extra_counts[joint] += 1;
            }
        });
        assert_eq!(fault, Some(Fault::LostCounts), "joint {joint}");
        assert_eq!(Fault::LostCounts.number(), 25);
        assert_eq!(Fault::LostCounts.response(), Response::PowerOff);
        let status = rig.controller.status();
        assert!(!status.homed, "the angles are unknown");
        assert_eq!(rig.tick().enable, [false; 2]);
    }
}

#[test]
fn a_pulse_says_nothing_of_angles_that_were_given() {
    let mut rig = homed(&with_index());
    // To somewhere between two pulses.
    let [x, y] = rig.tool_position();
    let to = [x + 0.01, y - 0.02];
    rig.push(9, MoveKind::Line { to, feed: 0.1 }).unwrap();
    rig.run(10_000);
    rig.controller.request(Request::Disarm).unwrap();
    rig.run(1000);
    let angles = rig.bench.theta.map(|theta| theta as f32);
    rig.controller.request(Request::SetAngles(angles)).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    rig.run(100);
    assert_eq!(move_to_and_fro(&mut rig, |_, _| ()), None);
}

#[test]
fn an_index_output_that_stays_high_is_a_fault() {
    let mut rig = homed(&with_index());
    rig.run(100);
    let [x, y] = rig.tool_position();
    let to = [x, y - 0.05];
    rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    for _ in 0..1000 {
        rig.controller.feed_host_timeout();
        rig.planner.run(&mut rig.controller);
        let mut sample = rig.bench.sense();
        sample.index[1] = true;
        let command = rig.controller.tick(&sample);
        rig.bench.step(&command);
    }
    assert_eq!(rig.controller.status().fault, Some(Fault::LostCounts));
}

/// The search passes pulses that are not where the lost counts say, and finds the arm all the same.
#[test]
fn an_arm_that_has_lost_counts_finds_its_index_again() {
    let mut rig = homed(&with_index());
    let fault = move_to_and_fro(&mut rig, |tick, rig| {
        if (3000..4000).contains(&tick) && tick % 10 == 0 {
            rig.bench.extra_counts[0] += 1;
        }
    });
    assert_eq!(fault, Some(Fault::LostCounts));
    rig.run(5000);
    rig.controller.request(Request::ClearFault).unwrap();
    rig.controller.request(Request::Home).unwrap();
    while rig.controller.state() == State::Homing {
        rig.tick();
    }
    rig.run(2000);
    rig.controller.request(Request::Arm).unwrap();
    rig.run(100);
    assert_eq!(move_to_and_fro(&mut rig, |_, _| ()), None);
}

/// Joint 1's angle grows towards its switch, joint 4's falls.
#[test]
fn a_joint_at_its_switch_that_should_be_elsewhere_has_lost_counts() {
    for (joint, sign) in [(0, 1), (1, -1)] {
        let mut rig = Rig::armed(&settings());
        let fault = (0..8000).find_map(|_| {
            // The controller holds the arm by its counts, which fall behind.
            rig.bench.extra_counts[joint] -= sign;
            rig.tick();
            rig.controller.status().fault
        });
        assert_eq!(fault, Some(Fault::LostCounts), "joint {joint}");
    }
}

#[test]
fn a_switch_that_is_stuck_is_a_fault_and_a_disturbance_is_none() {
    for joint in 0..2 {
        let mut rig = Rig::armed(&settings());
        let mut pressed = [false; 2];
        pressed[joint] = true;
        rig.bench.stuck = Some(pressed);
        rig.run(47);
        rig.bench.stuck = None;
        rig.run(1000);
        assert_eq!(rig.controller.state(), State::Armed);
        rig.bench.stuck = Some(pressed);
        rig.run(70);
        assert_eq!(rig.controller.status().fault, Some(Fault::LostCounts));
    }
}
