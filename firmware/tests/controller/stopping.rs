//! The arm comes to rest as the cause demands: on its path and held, or with the bridges off.

use crate::rig::{OFF, Rig, settings, with};
use fivebar_firmware::controller::{Request, RequestError};
use fivebar_firmware::safety::{Fault, Limits, State};
use fivebar_firmware::{ActuatorCommand, MoveKind, Settings};

type Prepare<'a> = &'a dyn Fn(&mut Rig);

/// On its way along 60 mm at 0.1 m/s for a tenth of a second, at full speed.
fn running(settings: &Settings) -> Rig {
    let mut rig = Rig::armed(settings);
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    rig.run(1000);
    assert_eq!(rig.controller.state(), State::Running);
    rig
}

/// A tick in which the planner is in time and the host is silent.
fn silent(rig: &mut Rig) -> ActuatorCommand {
    rig.planner.run(&mut rig.controller);
    rig.tick_alone()
}

/// Runs to rest; the distance [m] of the tool meanwhile and the greatest change of its speed [m/s] in
/// a tick.
fn rest(rig: &mut Rig, mut tick: impl FnMut(&mut Rig) -> ActuatorCommand) -> (f64, f64) {
    let [start, _] = rig.bench.tool();
    let (mut before, mut speed, mut jerk) = (start, f64::NAN, 0.0_f64);
    for _ in 0..6000 {
        assert_eq!(tick(rig).enable, [true; 2]);
        let [x, _] = rig.bench.tool();
        let now = (before - x) * 1e4;
        jerk = jerk.max((now - speed).abs());
        (before, speed) = (x, now);
        if rig.controller.status().tag.is_none() && now.abs() < 1e-4 {
            return (start - x, jerk);
        }
    }
    panic!("still moving");
}

/// The stop takes T = 0.11 s, and v T/2 = 5.6 mm of path; 40 mm are left.
#[test]
fn a_silent_host_ends_the_motion_by_a_stop_and_not_at_the_end_of_the_path() {
    let mut rig = running(&settings());
    while rig.controller.fault().is_none() {
        silent(&mut rig);
    }
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
    let (distance, jerk) = rest(&mut rig, silent);
    assert!((0.002..0.012).contains(&distance), "{distance} m");
    assert!(jerk < 2e-3, "{jerk} m/s in a tick");
    let reference = rig.controller.status().reference.unwrap();
    for (tool, reference) in rig.bench.tool().into_iter().zip(reference) {
        assert!((tool - f64::from(reference)).abs() < 5e-5);
    }
}

#[test]
fn a_requested_stop_slows_down_on_the_path_and_drops_the_rest_of_it() {
    let mut rig = running(&settings());
    rig.controller.request(Request::Stop).unwrap();
    let (distance, jerk) = rest(&mut rig, Rig::tick);
    assert!((0.002..0.012).contains(&distance), "{distance} m");
    assert!(jerk < 2e-3, "{jerk} m/s in a tick");
    assert_eq!(rig.controller.state(), State::Armed);
    assert!(rig.planner.is_empty() || rig.controller.status().tag.is_none());
}

#[test]
fn a_stop_that_is_asked_for_again_on_the_way_goes_on_as_it_began() {
    let mut rig = running(&settings());
    let mut ticks = 0;
    let (distance, jerk) = rest(&mut rig, |rig| {
        if ticks % 300 == 0 && rig.controller.state() != State::Armed {
            rig.controller.request(Request::Stop).unwrap();
        }
        ticks += 1;
        rig.tick()
    });
    assert!((0.002..0.012).contains(&distance), "{distance} m");
    assert!(jerk < 2e-3, "{jerk} m/s in a tick");
}

#[test]
fn a_host_that_falls_silent_while_the_arm_stops_is_a_fault() {
    let mut rig = running(&with(|s| s.protection.command_timeout = 0.01));
    rig.controller.request(Request::Stop).unwrap();
    for tick in 1..=90 {
        assert_eq!(silent(&mut rig).enable, [true; 2]);
        assert_eq!(rig.controller.state(), State::Stopping, "tick {tick}");
    }
    for _ in 0..11 {
        assert_eq!(silent(&mut rig).enable, [true; 2]);
    }
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
    let moving = rig.controller.request(Request::ClearFault);
    assert_eq!(moving, Err(RequestError::Moving));
    rest(&mut rig, silent);
    assert_eq!(rig.controller.request(Request::ClearFault), Ok(()));
}

#[test]
fn a_host_that_falls_silent_while_the_arm_homes_switches_off() {
    let mut rig = Rig::new(&settings());
    rig.controller.request(Request::Home).unwrap();
    for tick in 1..=990 {
        assert_eq!(rig.tick_alone().enable, [true; 2], "tick {tick}");
    }
    for _ in 0..11 {
        rig.tick_alone();
    }
    assert_eq!(rig.tick_alone(), OFF);
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
    for _ in 0..100 {
        assert_eq!(rig.tick_alone(), OFF);
    }
    assert_eq!(rig.controller.request(Request::ClearFault), Ok(()));
    assert_eq!(rig.controller.state(), State::Stopped);
}

#[test]
fn an_arm_that_only_holds_may_have_a_silent_host() {
    let mut rig = Rig::armed(&settings());
    let generation = rig.controller.planning_snapshot().path_generation;
    for _ in 0..3000 {
        assert_eq!(silent(&mut rig).enable, [true; 2]);
    }
    // Nothing is dropped, either, where the tool is off.
    let after = rig.controller.planning_snapshot();
    assert_eq!(
        (after.state, after.path_generation),
        (State::Armed, generation)
    );
}

/// The planner had no time until the host fell silent.
#[test]
fn a_path_that_comes_late_does_not_begin_for_a_silent_host() {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    let before = rig.controller.status().reference;
    for _ in 0..1_010 {
        rig.tick_alone();
    }
    for _ in 0..100 {
        assert_eq!(silent(&mut rig).enable, [true; 2]);
        let status = rig.controller.status();
        assert_ne!(status.state, State::Running);
        assert_eq!(status.reference, before);
    }
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
    assert_eq!(rig.controller.request(Request::ClearFault), Ok(()));
}

#[test]
fn an_emergency_stop_switches_off_in_its_tick_in_every_state() {
    let homing = |rig: &mut Rig| rig.controller.request(Request::Home).unwrap();
    let stopping = |rig: &mut Rig| rig.controller.request(Request::Stop).unwrap();
    let held = |rig: &mut Rig| {
        while rig.controller.fault().is_none() {
            silent(rig);
        }
    };
    let nothing = |_: &mut Rig| ();
    let cases: [(Rig, Prepare<'_>, State); 6] = [
        (Rig::new(&settings()), &nothing, State::Stopped),
        (Rig::new(&settings()), &homing, State::Homing),
        (Rig::armed(&settings()), &nothing, State::Armed),
        (running(&settings()), &nothing, State::Running),
        (running(&settings()), &stopping, State::Stopping),
        (running(&settings()), &held, State::Fault),
    ];
    for (mut rig, prepare, state) in cases {
        prepare(&mut rig);
        rig.run(30);
        assert_eq!(rig.controller.state(), state);
        rig.bench.overlay.emergency_stop = true;
        assert_eq!(rig.tick(), OFF, "{state:?}");
        rig.bench.overlay.emergency_stop = false;
        let fault = rig.controller.fault().unwrap();
        assert_eq!((fault.fault, fault.state), (Fault::EmergencyStop, state));
        for _ in 0..100 {
            assert_eq!(rig.tick(), OFF, "{state:?}");
        }
    }
}

#[test]
fn the_first_power_off_fault_stays_latched() {
    let mut rig = Rig::armed(&settings());
    rig.bench.overlay.driver_fault = [true, false];
    rig.tick();
    let first = rig.controller.fault().unwrap();
    rig.bench.overlay.emergency_stop = true;
    rig.run(10);
    rig.controller.latch_fault(Fault::CommandTimeout);
    rig.controller.request(Request::EmergencyStop).unwrap();
    assert_eq!(rig.controller.fault(), Some(first));
    assert_eq!(rig.run(10), OFF);
}

#[test]
fn loops_and_observer_are_at_rest_as_soon_as_the_bridges_are_off() {
    let mut rig = running(&settings());
    rig.bench.push = [0.1, -0.05];
    rig.run(200);
    assert!(rig.controller.status().torque.iter().all(|&t| t != 0.0));
    rig.controller.request(Request::Disarm).unwrap();
    let settled = rig.controller.status();
    assert_eq!((settled.velocity, settled.torque), ([0.0; 2], [0.0; 2]));
    assert_eq!(rig.tick(), OFF);

    // A fault leaves the observer at work.
    let mut rig = running(&settings());
    let moving = rig.controller.status().velocity;
    rig.bench.overlay.emergency_stop = true;
    rig.tick();
    let off = rig.controller.status();
    assert_eq!((off.torque, off.current_demand), ([0.0; 2], [0.0; 2]));
    assert_eq!((off.duty, off.limits), ([0.0; 2], Limits::empty()));
    assert_eq!((off.reference, off.joint_reference), (None, None));
    for (off, before) in off.velocity.into_iter().zip(moving) {
        assert!((off - before).abs() < 0.1 * before.abs(), "{off}, {before}");
    }
}

/// 1.2 times the present voltage would be needed for either joint.
#[test]
fn a_bus_too_low_for_either_motor_is_reported_as_a_limit() {
    for push in [[0.6, 0.0], [0.0, 0.6]] {
        let mut rig = Rig::armed(&with(|s| {
            s.protection.bus_voltage = [1.0, 30.0];
            s.protection.following_error = 0.9;
        }));
        assert!(!rig.controller.status().limits.contains(Limits::VOLTAGE));
        rig.bench.bus = 3.0;
        rig.bench.push = push;
        let mut voltage = false;
        for _ in 0..600 {
            rig.tick();
            voltage |= rig.controller.status().limits.contains(Limits::VOLTAGE);
        }
        assert!(voltage, "{push:?}");
    }
}

/// A controlled stop needs a path, or a position to hold.
#[test]
fn a_fault_that_would_hold_the_arm_switches_off_where_nothing_is_held() {
    for state in [State::Stopped, State::Homing] {
        for fault in [Fault::CommandTimeout, Fault::QueueUnderrun] {
            let mut rig = Rig::new(&settings());
            if state == State::Homing {
                rig.controller.request(Request::Home).unwrap();
                rig.run(100);
            }
            assert_eq!(rig.controller.state(), state);
            rig.controller.latch_fault(fault);
            for _ in 0..100 {
                assert_eq!(rig.tick(), OFF, "{fault:?} while {state:?}");
            }
            assert_eq!(rig.controller.status().fault, Some(fault));
        }
    }
}

#[test]
fn a_stop_drops_the_path_of_an_arm_that_has_not_begun_it() {
    let mut rig = Rig::armed(&settings());
    let before = rig.bench.tool();
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(1, MoveKind::Line { to, feed: 0.1 }).unwrap();
    rig.planner.run(&mut rig.controller);
    rig.controller.request(Request::Stop).unwrap();
    rig.run(3000);
    assert_eq!(rig.controller.state(), State::Armed);
    for (after, before) in rig.bench.tool().into_iter().zip(before) {
        assert!((after - before).abs() < 1e-4, "{after} m");
    }
}

#[test]
fn a_planner_that_was_late_does_not_go_on_with_a_path_that_was_stopped() {
    let mut rig = running(&settings());
    rig.controller.request(Request::Stop).unwrap();
    while rig.controller.state() != State::Armed {
        rig.controller.feed_host_timeout();
        rig.tick_alone();
    }
    let [start, _] = rig.bench.tool();
    rig.run(3000);
    assert_eq!(rig.controller.state(), State::Armed);
    let [end, _] = rig.bench.tool();
    assert!((end - start).abs() < 2e-4, "{start} m, then {end} m");
    assert!(rig.planner.is_empty());
}

#[test]
fn what_was_latched_with_a_fault_stays_while_the_arm_comes_to_rest() {
    let mut rig = running(&settings());
    while rig.controller.fault().is_none() {
        silent(&mut rig);
    }
    let latched = rig.controller.fault();
    let _ = rest(&mut rig, silent);
    rig.bench.push = [0.02, -0.02];
    rig.run(200);
    assert_eq!(rig.controller.fault(), latched);
}
