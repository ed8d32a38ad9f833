//! Pins at power-up, ticks, and the order of power, brake and motion.

use super::arm::{BY, Connected};
use super::images::{Description, Signal};
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{DriveKind, Output, Pulses};
use fivebar_firmware::Request;
use fivebar_firmware::safety::State;
use std::f64::consts::TAU;

/// The program starts within this time after the power-up of a new chip, whose option bytes it programs first.
pub(crate) const START: Time = 350 * MILLISECOND;

/// Not for an instant, also while pins become outputs and before the first tick.
pub(crate) fn nothing_has_power_from_power_up_until_the_arm_is_armed(image: &'static Description) {
    let unit = image.unit(Vec::new());
    unit.run(START + 50 * MILLISECOND);
    let (mut client, _) = unit.open();
    assert_eq!(client.status().expect("an answer").0.state, State::Stopped);
    assert_eq!(unit.events(0), []);
    assert_eq!(unit.brake(0), []);
    for (at, outputs) in &unit.record.get().changes {
        assert_eq!(outputs.tool, Pulses::Released, "at {at} fs");
    }
    // The levels are driven, and not left to the resistors.
    let outputs = unit.outputs();
    assert_eq!(outputs.sleep, [image.off_level; 2]);
    assert_eq!(outputs.brake, Some(false));
    let off = |output: &Output| !matches!(output, Output::Pwm { .. } | Output::Idle(true));
    assert!(outputs.pwm.iter().all(off), "{:?}", outputs.pwm);
}

pub(crate) fn ticks_come_at_their_rate_from_the_first_one_on(image: &'static Description) {
    let mut arm = Connected::new(image);
    let mut look = || {
        let ticks = arm.status().tick;
        let now = arm.unit.now();
        arm.run(50 * MILLISECOND);
        (now, Time::from(ticks))
    };
    let [(first_at, first), (then_at, then)] = [look(), look()];
    // An exchange with the host takes a millisecond or two.
    let passed = (then_at - first_at) / image.tick;
    let off = passed.abs_diff(then - first);
    assert!(
        off <= 3 * MILLISECOND / image.tick,
        "{off} of {passed} ticks"
    );
    let begun = first_at / image.tick - first;
    assert!(
        begun <= START / image.tick,
        "the first tick is late by {begun}"
    );
    assert_eq!(arm.status().missed_ticks, 0);
}

/// When both joints get power, or lose it; within the frames of a tick at once.
#[track_caller]
fn both(arm: &Connected, from: Time, power: bool) -> Time {
    let events = arm.unit.events(from);
    let times = [0, 1].map(|joint| {
        let is =
            |event: &&(Time, usize, Signal)| event.1 == joint && event.2 == Signal::Power(power);
        let found: Vec<Time> = events.iter().filter(is).map(|event| event.0).collect();
        assert!(!found.is_empty(), "joint {joint}: no change to {power}");
        found[0]
    });
    let apart = times[0].abs_diff(times[1]);
    assert!(apart < 300 * MICROSECOND, "{apart} fs apart");
    times[0].max(times[1])
}

/// The brakes need 20 ms to release and to engage.
pub(crate) fn power_comes_before_the_brake_releases_and_goes_after_it_has_engaged(
    image: &'static Description,
) {
    let mut arm = Connected::new(image);
    for _ in 0..2 {
        let from = arm.unit.now();
        arm.arm();
        let powered = both(&arm, from, true);
        let [(released, true)] = arm.unit.brake(from)[..] else {
            panic!("the brake: {:?}", arm.unit.brake(from));
        };
        // On a bus the order of power takes some ticks.
        let awake = powered + image.wake - 5 * image.tick;
        assert!((awake..awake + 40 * MILLISECOND).contains(&released));

        let from = arm.unit.now();
        arm.request(Request::Disarm);
        arm.run(250 * MILLISECOND);
        let [(engaged, false)] = arm.unit.brake(from)[..] else {
            panic!("the brake: {:?}", arm.unit.brake(from));
        };
        let off = both(&arm, from, false);
        assert!(off >= engaged + 20 * MILLISECOND, "{engaged} {off}");
        assert_eq!(arm.status().state, State::Stopped);
        arm.is_off_after(0);
    }
}

/// Nothing pushes while a drive wakes up, and then no more than holds the arm: of steppers, no step at all.
pub(crate) fn arming_moves_no_joint_also_after_a_motion(image: &'static Description) {
    let mut arm = Connected::new(image);
    for round in 0..2 {
        let before = arm.angles();
        let from = arm.unit.now();
        arm.arm();
        let after = arm.angles();
        for joint in 0..2 {
            let moved = (after[joint] - before[joint]).abs();
            assert!(moved < 2e-3, "joint {joint} moves by {moved} rad");
        }
        let powered = both(&arm, from, true);
        for (at, joint, signal) in arm.unit.events(from) {
            let Signal::Push(push) = signal else { continue };
            let most = match image.drives {
                DriveKind::Steppers => 0.0,
                DriveKind::Brushed if at < powered + image.wake => 0.0,
                DriveKind::OnBus if at < powered => 0.0,
                DriveKind::Brushed | DriveKind::OnBus => 0.2,
            };
            assert!(push.abs() <= most, "joint {joint}: {push} in round {round}");
        }
        arm.go(BY, image.speed);
        arm.finish();
        arm.request(Request::Disarm);
        arm.run(250 * MILLISECOND);
        assert_eq!(arm.status().state, State::Stopped);
    }
}

pub(crate) fn a_move_turns_both_joints_as_far_as_it_says(image: &'static Description) {
    let mut arm = Connected::armed(image);
    let (before, from) = (arm.angles(), arm.unit.now());
    arm.go(BY, image.speed);
    arm.finish();
    arm.is_pushed_from(from);
    let after = arm.angles();
    for joint in 0..2 {
        let axis = &arm.settings.axes[joint];
        if image.drives == DriveKind::Steppers {
            let steps: f64 = arm
                .unit
                .events(from)
                .iter()
                .fold(0.0, |sum, event| match *event {
                    (_, of, Signal::Push(step)) if of == joint => sum + step,
                    _ => sum,
                });
            let turns = f64::from(BY[joint]) / TAU * f64::from(axis.gear_ratio);
            let wanted = turns * f64::from(axis.encoder_counts);
            assert!(
                (steps - wanted).abs() <= 1.0,
                "joint {joint}: {steps} of {wanted}"
            );
        } else {
            let off = (after[joint] - before[joint] - BY[joint]).abs();
            assert!(off < 5e-3, "joint {joint} is off by {off} rad");
        }
    }
}

pub(crate) fn a_stop_on_the_path_ends_the_motion_and_disarming_the_power(
    image: &'static Description,
) {
    let mut arm = Connected::moving(image);
    arm.request(Request::Stop);
    arm.finish();
    assert_eq!(arm.unit.outputs().tool, Pulses::Level(false));
    let (before, from) = (arm.angles(), arm.unit.now());
    arm.run(50 * MILLISECOND);
    assert_eq!(arm.unit.is_powered(), [true; 2], "it is held");
    if image.drives == DriveKind::Steppers {
        arm.nothing_reaches_a_joint_from(from);
    }
    let after = arm.angles();
    for joint in 0..2 {
        let moved = (after[joint] - before[joint]).abs();
        assert!(moved < 1e-3, "joint {joint} moves by {moved} rad");
    }
    arm.request(Request::Disarm);
    arm.is_off_after(250 * MILLISECOND);
    assert_eq!(arm.status().fault, None);
}

/// Each access to a register over a slower bus makes the core wait, which the bounds of the machine code do not see:
/// `docs/verify/bounds.md` adds the counts of `accesses.txt`. The ticks here arm, move, stop by pin and come back.
pub(crate) fn a_tick_accesses_as_many_slow_registers_as_the_bounds_add(
    image: &'static Description,
) {
    let arm = Connected::moving(image);
    let stop = image.stops[0];
    // The stop comes in one tick or another: a tick takes more frames of drives than the next one.
    for level in [Some(true), Some(false)].repeat(8) {
        arm.unit.record.force(stop, level);
        arm.unit.chip().pins_changed();
        arm.run(10 * image.tick + image.tick / 8);
    }
    let [first, second] = arm.unit.chip().most_accesses_in_a_tick();
    let found = format!("{}: {first} {second}", image.file);
    let stated = include_str!("../../accesses.txt");
    assert!(stated.lines().any(|line| line == found), "{found}");
}
