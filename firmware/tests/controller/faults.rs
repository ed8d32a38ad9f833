//! Every fault, raised by its own cause: its number, bridges off in the tick that detects it (or a
//! controlled stop, if that is its response), the tool off in the same tick, and nothing moves until
//! it is cleared.

use crate::rig::{Bench, Rig, START, WAKING_TICKS, settings};
use fivebar_firmware::controller::{Controller, Request, RequestError};
use fivebar_firmware::safety::{Fault, Response, State};
use fivebar_firmware::{ActuatorCommand, FULL_TOOL, Move, MoveKind, Settings};

/// Runs ticks until a fault is latched, at most `within`, and checks what every power-off fault
/// must do.
#[track_caller]
fn powers_off(rig: &mut Rig, fault: Fault, number: u8, within: u32) {
    assert_eq!(fault.number(), number);
    assert_eq!(fault.response(), Response::PowerOff);
    // A fault raised between ticks is latched at once; the next tick switches off.
    let between = rig.controller.fault().is_some();
    let mut command = ActuatorCommand::default();
    for _ in 0..within {
        command = rig.tick();
        if rig.controller.state() == State::Fault {
            break;
        }
    }
    assert_eq!(rig.controller.state(), State::Fault);
    let snapshot = rig.controller.fault().unwrap();
    let tick = rig.controller.status().tick;
    assert_eq!(snapshot.tick, if between { tick - 1 } else { tick });
    stays_off(rig, command, fault);
}

#[track_caller]
fn stays_off(rig: &mut Rig, mut command: ActuatorCommand, fault: Fault) {
    let snapshot = rig.controller.fault().unwrap();
    assert_eq!(snapshot.fault, fault);
    for _ in 0..200 {
        assert_eq!(command.drives.duty, [0.0; 2]);
        assert_eq!(command.enable, [false; 2]);
        assert!(command.brake);
        assert_eq!(command.tool, 0);
        command = rig.tick();
    }
    let state = RequestError::State(State::Fault);
    for request in [Request::Arm, Request::Home, Request::Stop, Request::Disarm] {
        assert_eq!(rig.controller.request(request), Err(state));
    }
    let error = rig.push(1, MoveKind::Dwell { duration: 1.0 }).unwrap_err();
    assert_eq!(error.tag, 1);
    let latched = rig.controller.fault().unwrap();
    assert_eq!((latched.fault, latched.tick), (fault, snapshot.tick));
}

#[track_caller]
fn clears(rig: &mut Rig) {
    rig.controller.request(Request::ClearFault).unwrap();
    assert_eq!(rig.run(1).enable, [false; 2]);
    assert_eq!(rig.controller.state(), State::Stopped);
    assert!(rig.controller.fault().is_none());
}

fn with(change: impl FnOnce(&mut Settings)) -> Settings {
    let mut settings = settings();
    change(&mut settings);
    settings
}

/// An arm that draws a line of 60 mm at 0.2 m/s.
fn running() -> Rig {
    let mut rig = Rig::armed(&settings());
    let [x, y] = rig.tool_position();
    let (tag, tool, to) = (3, FULL_TOOL, [x - 0.06, y]);
    let kind = MoveKind::Line { to, feed: 0.2 };
    let line = Move { tag, tool, kind };
    rig.planner.push(&mut rig.controller, &line).unwrap();
    let drawing = (rig.run(1500).tool, rig.controller.state());
    assert_eq!(drawing, (FULL_TOOL, State::Running));
    rig
}

#[test]
fn a_jumping_encoder() {
    let mut rig = Rig::armed(&settings());
    rig.bench.extra_counts = [0, 200];
    powers_off(&mut rig, Fault::EncoderJump, 1, 1);
    clears(&mut rig);
    // The joint's angle is unknown now.
    assert_eq!(
        rig.controller.request(Request::Arm),
        Err(RequestError::NotHomed)
    );
}

#[test]
fn a_following_error() {
    let mut rig = Rig::armed(&settings());
    // A little more than the motor's 0.75 N·m.
    rig.bench.push = [0.85, 0.0];
    powers_off(&mut rig, Fault::FollowingError, 3, 2000);
    clears(&mut rig);
    assert!(
        rig.controller.status().homed,
        "the angles are as good as before"
    );
}

#[test]
fn a_current_sensor_that_shows_nothing() {
    let mut rig = running();
    rig.bench.current_sensor[0] = |_| 0.0;
    powers_off(&mut rig, Fault::CurrentSensor, 23, 200);
    clears(&mut rig);
    assert!(rig.controller.status().homed, "the angles are known");
}

#[test]
fn an_encoder_that_stops_in_motion() {
    let mut rig = running();
    rig.bench.stuck_counts[0] = Some(rig.bench.sense().counts[0]);
    powers_off(&mut rig, Fault::EncoderStuck, 24, 80);
    clears(&mut rig);
    assert!(!rig.controller.status().homed, "home again");
}

#[test]
fn over_speed() {
    let mut rig = Rig::armed(&with(|s| s.protection.following_error = 0.9));
    rig.bench.push = [-8.0, 0.0];
    powers_off(&mut rig, Fault::OverSpeed, 4, 2000);
}

#[test]
fn over_current() {
    let mut rig = Rig::armed(&settings());
    rig.bench.current = [0.0, -6.5];
    powers_off(&mut rig, Fault::OverCurrent, 5, 1);
}

#[test]
fn over_temperature() {
    let mut rig = Rig::armed(&with(|s| {
        s.axes[1].continuous_current = 0.3;
        s.axes[1].thermal_time_constant = 0.5;
    }));
    // 0.53 A to hold against, from 0.3 of the heat: hot after 0.5 ln((0.28 − 0.03)/(0.28 − 0.09)) s
    // = 0.14 s.
    rig.bench.push = [0.0, 0.1];
    rig.run(500);
    assert_eq!(rig.controller.state(), State::Armed);
    powers_off(&mut rig, Fault::OverTemperature, 6, 2000);
}

/// A controller that expects rotors with two hundred times the inertia has too much gain for any loop.
#[test]
fn a_loop_that_oscillates() {
    let mut rig = Rig::new(&with(|s| {
        s.axes
            .iter_mut()
            .for_each(|axis| axis.rotor_inertia *= 200.0);
    }));
    rig.bench = Bench::new(&settings());
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    rig.run(WAKING_TICKS + 1);
    let [x, y] = rig.tool_position();
    let to = [x - 0.06, y];
    rig.push(3, MoveKind::Line { to, feed: 0.2 }).unwrap();
    powers_off(&mut rig, Fault::Oscillation, 19, 5000);
    clears(&mut rig);
    assert!(rig.controller.status().homed, "the angles are known");
}

#[test]
fn a_sagging_and_a_rising_bus() {
    for (bus, fault, number) in [
        (17.9, Fault::UnderVoltage, 7),
        (30.1, Fault::OverVoltage, 8),
    ] {
        let mut rig = Rig::armed(&settings());
        rig.bench.bus = bus;
        powers_off(&mut rig, fault, number, 1);
    }
}

#[test]
fn a_driver_that_reports_a_fault() {
    let mut rig = Rig::armed(&settings());
    rig.bench.overlay.driver_fault = [false, true];
    powers_off(&mut rig, Fault::DriverFault, 9, 1);
}

#[test]
fn the_emergency_stop_as_a_button_and_as_a_request() {
    let mut rig = running();
    rig.bench.overlay.emergency_stop = true;
    powers_off(&mut rig, Fault::EmergencyStop, 10, 1);
    // If the fault is cleared while the button is still pressed, it is raised again.
    rig.controller.request(Request::ClearFault).unwrap();
    powers_off(&mut rig, Fault::EmergencyStop, 10, 1);
    rig.bench.overlay.emergency_stop = false;
    clears(&mut rig);

    let mut rig = running();
    rig.controller.request(Request::EmergencyStop).unwrap();
    powers_off(&mut rig, Fault::EmergencyStop, 10, 1);
}

#[test]
fn a_joint_pushed_out_of_its_limits_leaves_the_envelope() {
    let mut rig = Rig::armed(&with(|s| s.axes[0].angle_limits = [0.6, START[0] + 0.001]));
    rig.bench.push = [0.85, 0.0];
    powers_off(&mut rig, Fault::Envelope, 11, 2000);
}

#[test]
fn an_arm_pushed_towards_a_singularity_leaves_the_envelope() {
    let mut rig = Rig::armed(&with(|s| {
        s.motion.singularity_margin = 0.6;
        s.protection.following_error = 0.99;
    }));
    // Towards B = D.
    rig.bench.push = [-0.82, 0.82];
    powers_off(&mut rig, Fault::Envelope, 11, 5000);
}

#[test]
fn ticks_missed_while_powered() {
    let mut rig = Rig::armed(&settings());
    let miss = |rig: &mut Rig, ticks| {
        rig.bench.overlay.missed_ticks = ticks;
        let command = rig.tick();
        rig.bench.overlay.missed_ticks = 0;
        command
    };
    miss(&mut rig, 2);
    rig.run(10);
    assert_eq!(rig.controller.state(), State::Armed);
    assert_eq!(rig.controller.status().missed_ticks, 2);
    let command = miss(&mut rig, 3);
    assert_eq!(Fault::TickOverrun.number(), 14);
    stays_off(&mut rig, command, Fault::TickOverrun);
    assert_eq!(rig.controller.status().missed_ticks, 5);
    clears(&mut rig);
    // With the bridges off, as when the flash is erased, missed ticks are only counted.
    miss(&mut rig, 10_000);
    assert_eq!(rig.controller.state(), State::Stopped);
}

#[test]
fn a_number_that_overflows() {
    // The settings are finite, but the torques overflow.
    let mut rig = Rig::new(&settings());
    let heavy = with(|s| {
        s.gravity = [0.0, -3e38];
        s.payload = 30.0;
    });
    rig.controller = Controller::new(&heavy.check().unwrap());
    rig.run(1);
    rig.controller.request(Request::SetAngles(START)).unwrap();
    rig.controller.request(Request::Arm).unwrap();
    rig.run(WAKING_TICKS);
    // Off in this tick, latched in the next one.
    assert_eq!(rig.run(1).enable, [false; 2]);
    powers_off(&mut rig, Fault::NotANumber, 15, 1);
    clears(&mut rig);
}

#[test]
fn what_the_board_finds() {
    for (fault, number) in [
        (Fault::ClockFailure, 16),
        (Fault::WatchdogReset, 17),
        (Fault::SettingsCorrupt, 18),
        (Fault::Panic, 27),
        (Fault::HardFault, 28),
        (Fault::BrownOut, 29),
        (Fault::UnexpectedReset, 30),
        (Fault::DriveSilent, 31),
        (Fault::DriveError, 32),
        (Fault::BusOff, 33),
        (Fault::StepsLost, 34),
    ] {
        let mut rig = Rig::new(&settings());
        rig.controller.latch_fault(fault);
        powers_off(&mut rig, fault, number, 1);
        clears(&mut rig);
    }
}

/// It does what a tick does behind that fault.
#[test]
fn a_tick_without_clock() {
    let mut rig = Rig::new(&settings());
    for ticks in [0, 40] {
        if ticks > 0 {
            rig.run(1);
            rig.controller.request(Request::SetAngles(START)).unwrap();
            rig.controller.request(Request::Arm).unwrap();
            rig.run(WAKING_TICKS + ticks);
        }
        let (mut one, mut other) = (rig.controller.clone(), rig.controller.clone());
        for _ in 0..20 {
            let sample = rig.bench.sense();
            let command = one.tick_without_clock(&sample);
            other.latch_fault(Fault::ClockFailure);
            assert_eq!(command, other.tick(&sample));
            assert_eq!(one.status(), other.status());
            assert_eq!(command.enable, [false; 2]);
        }
    }
}

/// Runs until the arm rests, held by a fault; returns the greatest distance from the line and
/// the number of ticks.
fn comes_to_rest(rig: &mut Rig, mut tick: impl FnMut(&mut Rig) -> ActuatorCommand) -> (f64, u32) {
    let y = rig.bench.tool()[1];
    let mut off = 0.0_f64;
    for ticks in 0..5000 {
        let before = rig.bench.tool()[0];
        let command = tick(rig);
        assert_eq!(command.enable, [true; 2], "{:?}", rig.controller.fault());
        assert!(command.tool == 0 || rig.controller.fault().is_none());
        off = off.max((rig.bench.tool()[1] - y).abs());
        let moved = (rig.bench.tool()[0] - before).abs();
        let clearable = rig.controller.status().tag.is_none();
        if clearable && moved < 1e-8 {
            return (off, ticks);
        }
    }
    panic!("still moving");
}

#[test]
fn a_silent_host_stops_the_arm_on_its_path_and_holds_it() {
    let mut rig = running();
    // The planner is in time, but the host is silent.
    let alone = |rig: &mut Rig| {
        rig.planner.run(&mut rig.controller);
        rig.tick_alone()
    };
    let silence = (0..2000)
        .take_while(|_| {
            alone(&mut rig);
            rig.controller.state() != State::Fault
        })
        .count();
    // 0.1 s, the tick of the fault included, or some ticks less.
    assert!((990..=999).contains(&silence), "{silence} ticks");
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
    assert_eq!(Fault::CommandTimeout.number(), 12);
    assert_eq!(
        rig.controller.request(Request::ClearFault),
        Err(RequestError::Moving)
    );
    let (off, ticks) = comes_to_rest(&mut rig, alone);
    assert!(off < 3e-5, "{off} m off the line");
    assert!(ticks < 1500, "{ticks} ticks");
    let held = rig.bench.theta;
    rig.bench.push = [0.05, 0.05];
    for _ in 0..5000 {
        alone(&mut rig);
    }
    for (theta, held) in rig.bench.theta.into_iter().zip(held) {
        // Within the five counts by which an arm at rest may be off.
        assert!((theta - held).abs() < 8e-4, "held");
    }
    assert!(rig.push(9, MoveKind::Dwell { duration: 1.0 }).is_err());
    clears(&mut rig);
}

#[test]
fn a_planner_that_falls_behind_stops_the_arm_on_its_path() {
    let mut rig = running();
    let starved = |rig: &mut Rig| {
        rig.controller.feed_host_timeout();
        rig.tick_alone()
    };
    let (off, _) = comes_to_rest(&mut rig, starved);
    assert_eq!(rig.controller.status().fault, Some(Fault::QueueUnderrun));
    assert_eq!(Fault::QueueUnderrun.number(), 13);
    assert!(off < 3e-5, "{off} m off the line");
    clears(&mut rig);
}

#[test]
fn a_power_off_fault_replaces_one_that_holds() {
    let mut rig = running();
    for _ in 0..1200 {
        rig.planner.run(&mut rig.controller);
        rig.tick_alone();
    }
    assert_eq!(rig.controller.status().fault, Some(Fault::CommandTimeout));
    rig.bench.overlay.driver_fault = [true, false];
    let command = rig.tick();
    let tick = rig.controller.status().tick;
    assert_eq!(rig.controller.fault().unwrap().tick, tick);
    stays_off(&mut rig, command, Fault::DriverFault);
}

#[test]
fn numbers_are_stable_and_complete() {
    let numbers = Fault::all().map(Fault::number);
    assert!(numbers.eq(1..=34));
}

#[test]
fn the_same_samples_give_the_same_bits() {
    let run = || {
        let mut rig = running();
        (0..2000)
            .map(|_| rig.tick().drives.duty.map(f32::to_bits))
            .collect::<Vec<_>>()
    };
    assert_eq!(run(), run());
}
