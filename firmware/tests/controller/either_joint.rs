//! What switches the bridges off does so for either joint by itself, in the tick that shows it,
//! and by its own cause.

use crate::rig::{OFF, Rig, START, settings, with};
use fivebar_firmware::MoveKind;
use fivebar_firmware::controller::{Controller, Request, RequestError};
use fivebar_firmware::safety::{Fault, State};
use fivebar_kinematics::five_bar::{Geometry, Joint, Side};

/// A pair with `value` for this joint.
fn only<T: Copy>(joint: Joint, value: T, other: T) -> [T; 2] {
    let mut pair = [other; 2];
    pair[joint] = value;
    pair
}

/// Runs until a fault; the ticks, its own included.
#[track_caller]
fn ticks_to(rig: &mut Rig, fault: Fault) -> u32 {
    for ticks in 1..5000 {
        let command = rig.tick();
        if rig.controller.state() == State::Fault {
            assert_eq!(rig.controller.status().fault, Some(fault));
            assert_eq!(command, OFF, "in the tick of the fault");
            assert_eq!(rig.tick(), OFF);
            return ticks;
        }
        assert_eq!(command.enable, [true; 2]);
    }
    panic!("no fault");
}

#[test]
fn a_bridge_that_reports_a_fault_switches_both_off_in_its_tick() {
    for joint in Joint::ALL {
        let mut rig = Rig::armed(&settings());
        rig.bench.overlay.driver_fault = only(joint, true, false);
        assert_eq!(ticks_to(&mut rig, Fault::DriverFault), 1);
    }
    let mut rig = Rig::armed(&settings());
    rig.bench.overlay.driver_fault = [true; 2];
    assert_eq!(ticks_to(&mut rig, Fault::DriverFault), 1);
}

#[test]
fn too_much_current_of_either_sign_switches_off_in_its_tick() {
    for (joint, current) in [
        (Joint::Joint1, 6.05),
        (Joint::Joint1, -6.05),
        (Joint::Joint4, 6.05),
        (Joint::Joint4, -6.05),
    ] {
        let mut rig = Rig::armed(&settings());
        rig.bench.current = only(joint, 5.95 * f64::signum(current), 0.0);
        assert_eq!(rig.tick().enable, [true; 2], "below the trip point");
        let mut rig = Rig::armed(&settings());
        rig.bench.current = only(joint, current, 0.0);
        assert_eq!(ticks_to(&mut rig, Fault::OverCurrent), 1);
    }
}

#[test]
fn an_encoder_that_jumps_switches_off_and_unhomes_in_its_tick_powered_or_not() {
    for (joint, counts) in [
        (Joint::Joint1, 200),
        (Joint::Joint1, -200),
        (Joint::Joint4, 200),
        (Joint::Joint4, -200),
    ] {
        let mut rig = Rig::armed(&settings());
        rig.bench.extra_counts = only(joint, counts, 0);
        assert_eq!(ticks_to(&mut rig, Fault::EncoderJump), 1);
        assert!(!rig.controller.status().homed);

        let mut rig = Rig::armed(&settings());
        rig.controller.request(Request::Disarm).unwrap();
        rig.run(10);
        rig.bench.extra_counts = only(joint, counts, 0);
        assert_eq!(rig.tick(), OFF);
        assert_eq!(rig.controller.status().fault, Some(Fault::EncoderJump));
        assert!(!rig.controller.status().homed);
        rig.run(100);
        rig.controller.request(Request::ClearFault).unwrap();
        let arm = rig.controller.request(Request::Arm);
        assert_eq!(arm, Err(RequestError::NotHomed));
    }
}

/// The joint's own error reaches the limit before anything else: its cause is in the snapshot.
#[test]
fn a_joint_that_does_not_follow_switches_off_at_its_limit() {
    for (joint, push) in [
        (Joint::Joint1, 0.85),
        (Joint::Joint1, -0.85),
        (Joint::Joint4, 0.85),
        (Joint::Joint4, -0.85),
    ] {
        let mut rig = Rig::armed(&settings());
        rig.bench.push = only(joint, push, 0.0);
        ticks_to(&mut rig, Fault::FollowingError);
        let error = rig.controller.fault().unwrap().error;
        assert!(error[joint].abs() > 0.05 && error[joint].abs() < 0.06);
        assert!(error[joint.other()].abs() < 0.05, "{error:?}");
    }
}

#[test]
fn a_joint_pushed_beyond_either_of_its_limits_leaves_the_envelope() {
    for (joint, push) in [
        (Joint::Joint1, 0.85),
        (Joint::Joint1, -0.85),
        (Joint::Joint4, 0.85),
        (Joint::Joint4, -0.85),
    ] {
        let start = START[joint];
        let mut rig = Rig::armed(&with(|s| {
            s.axes[joint].angle_limits = [start - 0.002, start + 0.002];
        }));
        rig.bench.push = only(joint, push, 0.0);
        ticks_to(&mut rig, Fault::Envelope);
        // Half of the following error behind the limit.
        let gone = (rig.controller.fault().unwrap().angle[joint] - start).abs();
        assert!(gone > 0.027 && gone < 0.03, "{gone} rad");
    }
}

#[test]
fn links_2_and_3_nearly_in_line_leave_the_envelope_at_half_of_the_margin() {
    let mut rig = Rig::armed(&with(|s| {
        s.motion.singularity_margin = 0.6;
        s.protection.following_error = 0.99;
        s.protection.over_speed = 100.0;
    }));
    // Towards B = D.
    rig.bench.push = [-0.82, 0.82];
    ticks_to(&mut rig, Fault::Envelope);
    let angle = rig.controller.fault().unwrap().angle;
    for (axis, angle) in settings().axes.iter().zip(angle) {
        let [low, high] = axis.angle_limits;
        assert!(low < angle && angle < high, "no joint limit: {angle}");
    }
    let geometry = Geometry::new(settings().lengths).unwrap();
    let pose = geometry.forward(angle[0], angle[1], Side::Left).unwrap();
    let sine = pose.sin32().abs();
    assert!((0.27..0.31).contains(&sine), "half of 0.6: {sine}");
}

/// 0.53 A against 0.3 A, from 0.3 of the heat: hot after 0.5 ln((0.28 − 0.03)/(0.28 − 0.09)) s = 0.14 s.
#[test]
fn a_motor_above_its_continuous_current_switches_off_when_the_model_says_so() {
    for joint in Joint::ALL {
        let mut rig = Rig::armed(&with(|s| {
            s.axes[joint].continuous_current = 0.3;
            s.axes[joint].thermal_time_constant = 0.5;
        }));
        rig.bench.push = only(joint, 0.1, 0.0);
        let ticks = ticks_to(&mut rig, Fault::OverTemperature);
        assert!((1000..2000).contains(&ticks), "{ticks} ticks");
    }
}

#[test]
fn a_motor_at_its_continuous_current_goes_on() {
    // 0.53 A hold the push.
    let mut rig = Rig::armed(&with(|s| {
        s.axes[1].continuous_current = 0.56;
        s.axes[1].thermal_time_constant = 0.1;
    }));
    rig.bench.push = [0.0, 0.1];
    rig.run(5000);
    assert_eq!(rig.controller.state(), State::Armed);
}

#[test]
fn a_joint_outside_either_of_its_limits_is_not_armed() {
    for (joint, at) in [
        (Joint::Joint1, 0.59),
        (Joint::Joint1, 3.61),
        (Joint::Joint4, -0.47),
        (Joint::Joint4, 2.55),
    ] {
        let mut rig = Rig::new(&settings());
        let angles = only(joint, at, START[joint.other()]);
        let set = rig.controller.request(Request::SetAngles(angles));
        assert_eq!(set, Err(RequestError::OutsideLimits), "{angles:?}");
        assert!(!rig.controller.status().homed);
    }
}

/// Joint 1's counter passes its greatest number on the way, joint 4's its least, or the reverse.
#[test]
fn a_counter_that_wraps_on_the_way_changes_nothing() {
    for sign in [1, -1] {
        let mut rig = Rig::new(&settings());
        let counts = rig.bench.sense().counts;
        rig.bench.extra_counts =
            [sign, -sign].map(|sign| if sign > 0 { i32::MAX } else { i32::MIN });
        for (extra, count) in rig.bench.extra_counts.iter_mut().zip(counts) {
            *extra = extra.wrapping_sub(count);
        }
        rig.controller = Controller::new(&settings().check().unwrap());
        rig.run(1);
        rig.controller.request(Request::SetAngles(START)).unwrap();
        rig.controller.request(Request::Arm).unwrap();
        for to in [[2.25, 0.95], [2.15, 0.85], [2.25, 0.85], [2.15, 0.95]] {
            rig.push(1, MoveKind::Joint { to, speed: 0.1 }).unwrap();
            rig.run(4000);
            assert_eq!(
                rig.controller.state(),
                State::Armed,
                "{:?}",
                rig.controller.fault()
            );
            for (theta, to) in rig.bench.theta.into_iter().zip(to) {
                assert!((theta - f64::from(to)).abs() < 5e-4, "{theta} for {to}");
            }
        }
    }
}

#[test]
fn an_encoder_that_jumps_while_ticks_are_missed_loses_the_angles() {
    for joint in Joint::ALL {
        let mut rig = Rig::armed(&settings());
        rig.bench.overlay.missed_ticks = 5;
        rig.bench.extra_counts = only(joint, 2000, 0);
        assert_eq!(rig.tick(), OFF);
        assert_eq!(rig.controller.status().fault, Some(Fault::TickOverrun));
        assert!(!rig.controller.status().homed);
    }
}

#[test]
fn an_emergency_stop_in_a_tick_after_missed_ones_is_the_fault_that_is_latched() {
    let mut rig = Rig::armed(&settings());
    rig.bench.overlay.missed_ticks = 5;
    rig.bench.overlay.emergency_stop = true;
    assert_eq!(rig.tick(), OFF);
    assert_eq!(rig.controller.status().fault, Some(Fault::EmergencyStop));
}
