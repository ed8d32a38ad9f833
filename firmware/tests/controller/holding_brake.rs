//! The order of power, holding brakes and motion.

use crate::rig::{Rig, START, WAKING_TICKS, settings, with};
use fivebar_firmware::controller::{Excitation, Excited, Request};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::BrakeSettings;
use fivebar_firmware::{ActuatorCommand, MoveKind, Settings};

/// Ticks in which the brakes engage, and in which they release.
const ENGAGING: u32 = 400;
const RELEASING: u32 = 500;
/// The longest test of the brakes, and the ticks by which turns may be late.
const TEST: u32 = 800 + 50;
const LATE: u32 = 40;

/// The bench's arm with brakes; the bench has none, but its arm lies flat.
fn braked() -> Settings {
    with(|s| {
        s.brake = BrakeSettings {
            engage_time: 0.04,
            release_time: 0.05,
        };
    })
}

/// The arm upright: without power it falls, because the bench has no brakes.
fn upright() -> Settings {
    Settings {
        gravity: [0.0, -9.81],
        ..braked()
    }
}

/// Armed, with free brakes.
fn free(settings: &Settings) -> Rig {
    let mut rig = Rig::armed(settings);
    rig.run(RELEASING + LATE);
    rig
}

/// Along a line of 40 mm.
fn push_line(rig: &mut Rig) {
    let [x, y] = rig.tool_position();
    let to = [x - 0.04, y];
    rig.push(3, MoveKind::Line { to, feed: 0.1 }).unwrap();
}

/// Runs until the bridges are off; returns the ticks with power before and after the brake was engaged.
#[track_caller]
fn ticks_until_off(rig: &mut Rig) -> [u32; 2] {
    let mut ticks = [0; 2];
    for _ in 0..60_000 {
        let command = rig.tick();
        assert_eq!(command.enable[0], command.enable[1]);
        if command.enable == [false; 2] {
            assert!(command.brake);
            return ticks;
        }
        assert!(command.brake || ticks[1] == 0, "released again");
        ticks[usize::from(command.brake)] += 1;
    }
    panic!("{ticks:?}: still on");
}

#[track_caller]
fn assert_held_until_braked(rig: &mut Rig) {
    let [_, braked] = ticks_until_off(rig);
    assert!(
        (ENGAGING..=ENGAGING + TEST + LATE).contains(&braked),
        "{braked} ticks"
    );
}

#[test]
fn a_path_begins_when_the_brakes_are_free() {
    let mut rig = Rig::new(&braked());
    rig.controller.request(Request::SetAngles(START)).unwrap();
    assert_begins_when_free(&mut rig);
    // Power that is lost at once engages the brakes: the next path waits for them as the first one.
    rig.run(5_000);
    rig.controller.request(Request::EmergencyStop).unwrap();
    rig.tick();
    rig.controller.request(Request::ClearFault).unwrap();
    assert_begins_when_free(&mut rig);
}

/// Arms the arm and pushes a line, which begins after the time that the brakes take to release.
#[track_caller]
fn assert_begins_when_free(rig: &mut Rig) {
    rig.controller.request(Request::Arm).unwrap();
    let waking = (0..100).take_while(|_| rig.tick().brake).count();
    assert_eq!(waking, WAKING_TICKS as usize, "released when awake");
    push_line(rig);
    let before = rig.bench.theta;
    let mut waited = 0;
    while rig.controller.state() == State::Armed {
        let command = rig.tick();
        assert_eq!((command.enable, command.brake), ([true; 2], false));
        waited += 1;
    }
    assert_eq!(rig.controller.state(), State::Running);
    assert!(
        (RELEASING..=RELEASING + LATE).contains(&waited),
        "{waited} ticks"
    );
    for (now, before) in rig.bench.theta.into_iter().zip(before) {
        assert!((now - before).abs() < 1e-3, "it is held meanwhile");
    }
}

#[test]
fn homing_begins_when_the_brakes_are_free_and_ends_when_they_hold() {
    let mut rig = Rig::new(&braked());
    rig.controller.request(Request::Home).unwrap();
    rig.run(WAKING_TICKS + RELEASING);
    for (theta, start) in rig.bench.theta.into_iter().zip(START) {
        assert!((theta - f64::from(start)).abs() < 1e-3, "{theta}");
    }
    assert_held_until_braked(&mut rig);
    let status = rig.controller.status();
    assert_eq!((status.state, status.homed), (State::Stopped, true));
}

#[test]
fn homing_that_is_stopped_ends_at_rest_when_the_brakes_hold() {
    for request in [Request::Stop, Request::Disarm] {
        let mut rig = Rig::new(&braked());
        rig.controller.request(Request::Home).unwrap();
        rig.run(2000);
        assert!(rig.bench.omega[0].abs() > 0.1, "it searches");
        rig.controller.request(request).unwrap();
        assert_held_until_braked(&mut rig);
        let status = rig.controller.status();
        assert_eq!((status.state, status.homed), (State::Stopped, false));
        assert!(rig.bench.omega[0].abs() < 0.05, "{:?}", rig.bench.omega);
    }
}

#[test]
fn a_disarmed_arm_is_held_until_the_brakes_are_engaged() {
    let mut rig = free(&braked());
    rig.controller.request(Request::Disarm).unwrap();
    assert_held_until_braked(&mut rig);
    assert_eq!(rig.controller.state(), State::Stopped);
}

#[test]
fn an_arm_that_is_disarmed_in_motion_stops_on_its_path_first() {
    let mut rig = free(&braked());
    push_line(&mut rig);
    rig.run(1500);
    assert_eq!(rig.controller.state(), State::Running);
    rig.controller.request(Request::Disarm).unwrap();
    while rig.controller.state() == State::Stopping {
        let command = rig.tick();
        assert_eq!((command.enable, command.brake), ([true; 2], false));
    }
    assert_held_until_braked(&mut rig);
    assert_eq!(rig.controller.state(), State::Stopped);
}

#[test]
fn the_path_of_an_arm_that_waits_for_its_brakes_is_dropped_with_them() {
    let mut rig = Rig::armed(&braked());
    push_line(&mut rig);
    rig.run(100);
    rig.controller.request(Request::Disarm).unwrap();
    assert!(rig.push(4, MoveKind::Dwell { duration: 0.1 }).is_err());
    assert_held_until_braked(&mut rig);
    rig.controller.request(Request::Arm).unwrap();
    rig.run(3000);
    assert_eq!(rig.controller.state(), State::Armed);
    for (theta, start) in rig.bench.theta.into_iter().zip(START) {
        assert!((theta - f64::from(start)).abs() < 1e-3, "{theta}");
    }
}

#[test]
fn an_arm_that_is_armed_again_meanwhile_goes_on() {
    let mut rig = free(&braked());
    rig.controller.request(Request::Disarm).unwrap();
    assert!(rig.run(ENGAGING / 2).brake);
    rig.controller.request(Request::Arm).unwrap();
    assert!(!rig.tick().brake);
    push_line(&mut rig);
    rig.run(RELEASING - LATE);
    assert_eq!(rig.controller.state(), State::Armed);
    rig.run(2 * LATE);
    assert_eq!(rig.controller.state(), State::Running);
}

#[test]
fn an_arm_that_is_held_under_a_fault_is_held_until_the_brakes_are_engaged() {
    let mut rig = free(&braked());
    rig.controller.latch_fault(Fault::QueueUnderrun);
    rig.run(100);
    rig.controller.request(Request::ClearFault).unwrap();
    assert_held_until_braked(&mut rig);
    let status = rig.controller.status();
    assert_eq!((status.state, status.fault), (State::Stopped, None));
}

#[test]
fn an_arm_that_its_host_has_left_is_held_until_the_brakes_are_engaged() {
    let mut rig = free(&braked());
    let mut braked = 0;
    for _ in 0..602_000 {
        let command = rig.tick_alone();
        if command.enable == [false; 2] {
            break;
        }
        braked += u32::from(command.brake);
    }
    assert!((ENGAGING..=ENGAGING + TEST + LATE).contains(&braked));
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
    assert_eq!(rig.run(10).enable, [false; 2]);
}

#[test]
fn power_off_faults_and_the_emergency_stop_do_not_wait_for_the_brakes() {
    let stop = |rig: &mut Rig| rig.controller.request(Request::EmergencyStop).unwrap();
    let overcurrent = |rig: &mut Rig| rig.bench.current = [6.5, 0.0];
    for fault in [stop as fn(&mut Rig), overcurrent] {
        let mut rig = free(&braked());
        fault(&mut rig);
        let ActuatorCommand { enable, brake, .. } = rig.tick();
        assert_eq!((enable, brake), ([false; 2], true));
    }
}

/// The arm has not fallen: it is where it was, and held.
#[track_caller]
fn assert_held(rig: &mut Rig, before: [f64; 2]) {
    let command = rig.run(5000);
    let status = rig.controller.status();
    assert_eq!(
        (status.state, status.fault),
        (State::Fault, Some(Fault::BrakeFailed))
    );
    assert_eq!(command.enable, [true; 2]);
    for (theta, before) in rig.bench.theta.into_iter().zip(before) {
        assert!((theta - before).abs() < 2e-3, "{theta} for {before}");
    }
}

#[test]
fn brakes_that_do_not_hold_leave_the_arm_held_until_the_emergency_stop() {
    let mut rig = free(&upright());
    let before = rig.bench.theta;
    rig.controller.request(Request::Disarm).unwrap();
    let mut farthest = 0.0_f64;
    for _ in 0..3000 {
        rig.tick();
        for (theta, before) in rig.bench.theta.into_iter().zip(before) {
            farthest = farthest.max((theta - before).abs());
        }
    }
    assert!((0.01..0.025).contains(&farthest), "it fell {farthest} rad");
    assert_held(&mut rig, before);
    // A host that clears the fault asks for the same again.
    rig.controller.request(Request::ClearFault).unwrap();
    assert_held(&mut rig, before);
    rig.controller.request(Request::EmergencyStop).unwrap();
    assert_eq!(rig.tick().enable, [false; 2]);
    assert_eq!(rig.controller.status().fault, Some(Fault::EmergencyStop));
    rig.controller.request(Request::ClearFault).unwrap();
    assert_eq!(rig.controller.state(), State::Stopped);
}

#[test]
fn an_armed_arm_that_is_armed_again_keeps_its_free_brakes() {
    let mut rig = free(&braked());
    rig.controller.request(Request::Arm).unwrap();
    push_line(&mut rig);
    rig.run(LATE);
    assert_eq!(rig.controller.state(), State::Running);
}

#[test]
fn power_that_is_lost_while_an_arm_is_disarmed_ends_the_disarming() {
    let mut rig = free(&braked());
    rig.controller.request(Request::Disarm).unwrap();
    rig.run(20);
    rig.controller.request(Request::EmergencyStop).unwrap();
    rig.tick();
    rig.controller.request(Request::ClearFault).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    let command = rig.run(5000);
    assert_eq!(rig.controller.state(), State::Armed);
    assert_eq!((command.enable, command.brake), ([true; 2], false));
}

#[test]
fn a_stop_on_the_path_leaves_the_brakes_free() {
    let mut rig = free(&braked());
    push_line(&mut rig);
    rig.run(1000);
    assert_eq!(rig.controller.state(), State::Running);
    rig.controller.request(Request::Stop).unwrap();
    let command = rig.run(5000);
    assert_eq!(rig.controller.state(), State::Armed);
    assert_eq!((command.enable, command.brake), ([true; 2], false));
}

/// The bench's joints are free of each other: an upright arm's fall together.
#[test]
fn a_brake_that_does_not_hold_one_joint_is_found() {
    for joint in 0..2 {
        let mut rig = free(&braked());
        rig.bench.push[joint] = 0.2;
        rig.run(2000);
        rig.controller.request(Request::Disarm).unwrap();
        rig.run(3000);
        let fault = rig.controller.status().fault;
        assert_eq!(fault, Some(Fault::BrakeFailed), "joint {joint}");
    }
}

#[test]
fn brakes_that_do_not_hold_after_homing_leave_the_arm_held_where_it_was_homed() {
    let mut rig = Rig::new(&with(|s| {
        *s = upright();
        s.homing.current = 4.0;
    }));
    rig.controller.request(Request::Home).unwrap();
    for _ in 0..60_000 {
        rig.tick();
        if rig.controller.state() == State::Fault {
            break;
        }
    }
    let before = rig.bench.theta;
    assert_eq!(rig.controller.status().fault, Some(Fault::BrakeFailed));
    assert!(rig.controller.status().homed);
    let command = rig.run(5000);
    assert_eq!(command.enable, [true; 2]);
    for (theta, before) in rig.bench.theta.into_iter().zip(before) {
        assert!((theta - before).abs() < 0.02, "{theta} for {before}");
    }
}

#[test]
fn an_arm_with_brakes_that_failed_is_switched_off_when_its_host_has_left() {
    let mut rig = free(&upright());
    rig.controller.request(Request::Disarm).unwrap();
    rig.run(3000);
    assert_eq!(rig.controller.status().fault, Some(Fault::BrakeFailed));
    let off = (0..601_000).any(|_| rig.tick_alone().enable == [false; 2]);
    assert!(off, "it is not held for ever");
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
}

#[test]
fn an_excitation_waits_for_the_brakes_and_ends_when_they_hold() {
    let mut rig = Rig::new(&braked());
    let excitation = Excitation {
        joint: 0,
        of: Excited::Voltage,
        offset: 0.5,
        amplitude: 0.0,
        hold: 1,
        ticks: 100,
        current: 1.0,
        travel: 0.5,
    };
    rig.controller.request(Request::Excite(excitation)).unwrap();
    rig.run(WAKING_TICKS);
    let released = (0..2000)
        .take_while(|_| {
            let command = rig.tick();
            assert_eq!((command.enable, command.brake), ([true; 2], false));
            command.drives.duty == [0.0; 2]
        })
        .count();
    assert!((RELEASING as usize..=(RELEASING + LATE) as usize).contains(&released));
    while !rig.tick().brake {}
    let braked = (1..2000)
        .take_while(|_| {
            let command = rig.tick();
            assert!(command.drives.duty == [0.0; 2] && command.brake);
            command.enable == [true; 2]
        })
        .count();
    assert!(
        (ENGAGING as usize..=(ENGAGING + 3 * LATE) as usize).contains(&braked),
        "{braked} ticks"
    );
    assert_eq!(rig.controller.state(), State::Stopped);
}

#[test]
fn an_arm_without_brakes_is_switched_off_at_once() {
    let mut rig = Rig::armed(&settings());
    rig.controller.request(Request::Disarm).unwrap();
    assert_eq!(rig.tick().enable, [false; 2]);
}
