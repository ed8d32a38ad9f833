//! Homing without switches: hard stops, absolute encoders, given angles; and the samples that are believed.

#![allow(
    clippy::needless_range_loop,
    reason = "a joint's number names it in every array"
)]

use crate::rig::{Rig, START, with};
use fivebar_firmware::Settings;
use fivebar_firmware::controller::{Request, RequestError};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::{AxisField, Field, HomingMethod, SettingsError};
use fivebar_kinematics::five_bar::Joint;
use std::f64::consts::TAU;

/// Counts per turn of a joint of the rig's arm.
const TURN: i32 = 8 * 8192;
/// Stiffness [N·m/rad] and damping [N·m·s/rad] of the stops.
const STOP: [f64; 2] = [1000.0, 1.0];

/// An arm with stops 0.02 rad behind the range of its angles.
fn with_stops() -> Settings {
    with(|s| {
        s.home_reference.method = HomingMethod::HardStop;
        s.home_reference.samples = 50;
        s.homing.current = 0.8;
        s.axes[0].home_angle = 2.8;
        s.axes[0].angle_limits = [0.6, 2.78];
        s.axes[1].home_angle = 0.34;
        s.axes[1].angle_limits = [0.36, 2.54];
    })
}

/// Homes with stops at these angles [rad]. Returns the greatest current [A] and the ticks.
fn home(rig: &mut Rig, stops: [f64; 2]) -> (f64, u32) {
    rig.controller.request(Request::Home).unwrap();
    let mut greatest = 0.0_f64;
    for ticks in 0..100_000 {
        if rig.controller.state() != State::Homing {
            return (greatest, ticks);
        }
        for (joint, towards) in [1.0, -1.0].into_iter().enumerate() {
            let depth = towards * (rig.bench.theta[joint] - stops[joint]);
            let [stiffness, damping] = STOP;
            let push = stiffness * depth + damping * towards * rig.bench.omega[joint];
            rig.bench.push[joint] = if depth > 0.0 {
                -towards * push.max(0.0)
            } else {
                0.0
            };
            greatest = greatest.max(rig.bench.current[joint].abs());
        }
        rig.tick();
    }
    panic!("still homing");
}

#[test]
fn both_stops_are_found_at_limited_current_and_left_again() {
    let settings = with_stops();
    let mut rig = Rig::new(&settings);
    // No switch matters.
    rig.bench.stuck = Some([false, true]);
    let (greatest, _) = home(&mut rig, [2.8, 0.34]);
    let status = rig.controller.status();
    assert!(status.homed, "{:?}", rig.controller.fault());
    assert!(greatest < 1.1 * 0.8, "{greatest} A");
    for joint in 0..2 {
        let off = f64::from(status.angle[joint]) - rig.bench.theta[joint];
        // The stops yield by 0.15 mrad at 0.8 A.
        assert!(off.abs() < 3e-4, "{off} rad");
        let [low, high] = settings.axes[joint].angle_limits.map(f64::from);
        let theta = rig.bench.theta[joint];
        assert!(
            low < theta && theta < high,
            "{theta} rad: the arm cannot be armed"
        );
    }
    rig.controller.request(Request::Arm).unwrap();
}

#[test]
fn an_arm_that_starts_at_its_stops_finds_them() {
    let mut rig = Rig::new(&with_stops());
    rig.bench.theta = [2.8, 0.34];
    rig.controller = fivebar_firmware::Controller::new(&with_stops().check().unwrap());
    rig.run(1);
    home(&mut rig, [2.8, 0.34]);
    assert!(
        rig.controller.status().homed,
        "{:?}",
        rig.controller.fault()
    );
}

#[test]
fn a_stop_that_is_not_there_ends_in_a_fault_within_the_joints_range() {
    let mut rig = Rig::new(&with_stops());
    let (_, ticks) = home(&mut rig, [9.0, 0.34]);
    assert_eq!(rig.controller.status().fault, Some(Fault::Envelope));
    assert!(!rig.controller.status().homed);
    // 2.18 rad and twice the angle back at 0.7 rad/s, from a reference that gets there in 0.1 s.
    let gone = rig.bench.theta[0] - f64::from(START[0]);
    assert!(gone < 2.4, "{gone} rad");
    assert!(ticks < 35_000, "{ticks} ticks");
}

#[test]
fn a_joint_without_current_feels_no_stop() {
    let mut rig = Rig::new(&with_stops());
    // The sensors read no current, so the loops cannot limit it either.
    rig.controller.request(Request::Home).unwrap();
    for _ in 0..100_000 {
        let fault = rig.controller.fault();
        if fault.is_some() || rig.controller.state() != State::Homing {
            break;
        }
        rig.bench.push = Joint::ALL.map(|joint| {
            let [towards, stop] = [[1.0, 2.8], [-1.0, 0.34]][joint];
            let depth = towards * (rig.bench.theta[joint] - stop);
            -towards
                * (STOP[0] * depth + STOP[1] * towards * rig.bench.omega[joint]).max(0.0)
                * f64::from(u8::from(depth > 0.0))
        });
        let mut sample = rig.bench.sense();
        sample.drives.current = [2048; 2];
        let command = rig.controller.tick(&sample);
        rig.controller.feed_host_timeout();
        rig.bench.step(&command);
    }
    assert!(!rig.controller.status().homed);
    assert!(rig.controller.fault().is_some());
}

#[test]
fn an_absolute_encoder_gives_the_angles_in_any_turn_without_a_motion() {
    let settings = with(|s| {
        s.home_reference.method = HomingMethod::Absolute;
        s.axes[1].gear_ratio = -8.0;
        // The arm stands more than half a turn before it.
        s.axes[0].home_angle = 5.6;
        s.axes[0].angle_limits = [0.6, 5.7];
    });
    for turns in [[0, 0], [3, -2], [-1, 40]] {
        let mut rig = Rig::new(&settings);
        for joint in 0..2 {
            let axis = &settings.axes[joint];
            let home = f64::from(axis.home_angle) / TAU * f64::from(TURN);
            let sign = axis.gear_ratio.signum() as i32;
            rig.bench.extra_counts[joint] = sign * (turns[joint] * TURN - home.round() as i32);
        }
        rig.controller = fivebar_firmware::Controller::new(&settings.check().unwrap());
        rig.run(1);
        rig.controller.request(Request::Home).unwrap();
        for _ in 0..100 {
            let command = rig.run(1);
            assert_eq!(command.drives.duty, [0.0; 2]);
        }
        let status = rig.controller.status();
        assert!(
            status.homed && status.state == State::Stopped,
            "{:?}",
            rig.controller.fault()
        );
        for joint in 0..2 {
            let off = f64::from(status.angle[joint]) - f64::from(START[joint]);
            assert!(
                off.abs() < 2.0 * TAU / f64::from(TURN),
                "{off} rad, {turns:?}"
            );
        }
    }
}

#[test]
fn given_angles_are_those_of_home_and_are_not_taken_from_an_arm_that_moves() {
    let settings = with(|s| {
        s.home_reference.method = HomingMethod::Given;
        s.axes[0].home_angle = START[0];
        s.axes[1].home_angle = START[1];
    });
    let mut rig = Rig::new(&settings);
    rig.bench.push = [0.02, 0.0];
    rig.run(200);
    assert_eq!(
        rig.controller.request(Request::Home),
        Err(RequestError::Moving)
    );
    let mut rig = Rig::new(&settings);
    rig.bench.extra_counts = [777, -999_999];
    rig.controller = fivebar_firmware::Controller::new(&settings.check().unwrap());
    rig.run(1);
    rig.controller.request(Request::Home).unwrap();
    for _ in 0..100 {
        assert_eq!(rig.run(1).drives.duty, [0.0; 2]);
    }
    let status = rig.controller.status();
    assert!(status.homed && status.state == State::Stopped);
    for joint in 0..2 {
        assert!((status.angle[joint] - START[joint]).abs() < 1e-3);
    }
}

#[test]
fn a_switch_is_believed_after_the_samples_of_the_settings() {
    for samples in [1_u8, 30] {
        let mut rig = Rig::new(&with(|s| s.home_reference.samples = samples));
        rig.bench.stuck = Some([false, true]);
        rig.controller.request(Request::Home).unwrap();
        // One sample is closed of the switch of joint 1, then it is open again.
        rig.run(200);
        let before = rig.bench.omega[0];
        rig.bench.stuck = Some([true, true]);
        rig.run(1);
        rig.bench.stuck = Some([false, true]);
        rig.run(1500);
        let turned_back = rig.bench.omega[0] < 0.0;
        assert_eq!(turned_back, samples == 1, "{before} {}", rig.bench.omega[0]);
    }
}

/// A change of the settings, and the field that is refused for it.
type Refusal = (fn(&mut Settings), SettingsError);

#[test]
fn methods_that_do_not_fit_the_arm_are_refused_by_name() {
    let method = SettingsError::Field(Field::HomingMethod);
    let refusals: [Refusal; 7] = [
        (
            |s| s.home_reference.samples = 0,
            SettingsError::Field(Field::HomingSamples),
        ),
        (|s| s.homing.current = 1.31, method),
        (
            |s| s.home_reference.samples = 255,
            SettingsError::Field(Field::HomingMethod),
        ),
        (|s| s.axes[0].angle_limits[1] = 2.81, method),
        (|s| s.axes[0].angle_limits[1] = 2.74, method),
        (|s| s.axes[1].angle_limits[0] = 0.33, method),
        (
            |s| s.axes[1].home_angle = 7.0,
            SettingsError::Axis(4, AxisField::HomeAngle),
        ),
    ];
    with_stops().check().unwrap();
    for (index, (change, refusal)) in refusals.into_iter().enumerate() {
        let mut settings = with_stops();
        // Fast enough that 255 samples are too many.
        settings.homing.speed = 1.0;
        change(&mut settings);
        assert_eq!(settings.check().unwrap_err(), refusal, "{index}");
    }
    let wide = with(|s| {
        s.home_reference.method = HomingMethod::Absolute;
        s.axes[0].angle_limits = [-3.2, 3.2];
    });
    assert_eq!(wide.check().unwrap_err(), method);
}
