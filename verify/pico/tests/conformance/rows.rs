//! The rows: what every image must do, as `verify/chip` has it for those of the first board.

use crate::bench::{Bench, frame};
use crate::images::{BITTEN, Description, FRAME, go, pass};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::{HostCommand, Reset};
use fivebar_firmware::safety::{Fault, State};
use fivebar_pico::{Chip, HZ};

pub(crate) fn nothing_has_power_from_power_up_until_the_arm_is_armed(image: &Description) {
    let mut bench = image.started();
    assert!(bench.line.chip().wires().pulses.is_empty());
    for _ in 0..5 {
        assert!(!image.has_power(&mut bench));
        bench.line.chip().run(HZ / 50).expect("it runs");
    }
    let mut bench = image.armed();
    assert!(image.has_power(&mut bench));
}

pub(crate) fn ticks_come_at_their_rate_from_the_first_one_on(image: &Description) {
    let bench = image.started();
    let mut chip = bench.line.chip();
    let before = chip.ticks;
    chip.run(HZ / 10).expect("it runs");
    let ticks = chip.ticks - before;
    assert!((999..=1001).contains(&ticks), "{ticks} in 1000 periods");
    drop(chip);
    let mut bench = bench;
    assert_eq!(bench.status().missed_ticks, 0);
}

pub(crate) fn arming_moves_no_joint_also_after_a_motion(image: &Description) {
    let mut bench = image.moving();
    pass(&mut bench, HZ * 3 / 2);
    let before = place(image, &mut bench);
    bench.request(Request::Disarm).expect("accepted");
    bench.line.chip().run(HZ / 5).expect("it runs");
    let again = if bench.status().homed {
        Request::Arm
    } else {
        let [axis1, axis4] = &bench.settings.axes;
        Request::SetAngles([axis1.home_angle, axis4.home_angle])
    };
    bench.request(again).expect("accepted");
    bench.line.chip().run(HZ * 3 / 10).expect("it runs");
    assert_eq!(bench.status().state, State::Armed);
    assert_eq!(place(image, &mut bench), before);
}

/// Where the joints are told to be: steps that were made, or the lengths of the last pulses.
fn place(image: &Description, bench: &mut Bench) -> [i64; 2] {
    let mut chip = bench.line.chip();
    let wires = chip.wires();
    if !image.by_pulses {
        return wires.edges.map(i64::from);
    }
    [0, 1].map(|joint| {
        let of_joint = wires.pulses.iter().rev().find(|pulse| pulse.joint == joint);
        of_joint.map_or(0, |pulse| pulse.cycles as i64)
    })
}

pub(crate) fn a_stop_on_the_path_ends_the_motion_and_disarming_the_power(image: &Description) {
    let mut bench = image.moving();
    bench.request(Request::Stop).expect("accepted");
    pass(&mut bench, HZ / 2);
    let before = place(image, &mut bench);
    pass(&mut bench, HZ / 5);
    assert_eq!(place(image, &mut bench), before);
    assert_eq!(bench.status().fault, None);
    assert!(image.has_power(&mut bench));
    bench.request(Request::Disarm).expect("accepted");
    bench.line.chip().run(HZ / 5).expect("it runs");
    image.is_off_after(&mut bench, FRAME);
}

/// The program ends in motion, and starts again.
#[track_caller]
fn ends(image: &Description, within: u64, end: impl FnOnce(&mut Chip), reset: Reset, fault: Fault) {
    let mut bench = image.moving();
    end(&mut bench.line.chip());
    image.is_off_after(&mut bench, within);
    bench.line.chip().run(BITTEN).expect("it starts again");
    Description::has_restarted(&mut bench, reset, fault);
}

pub(crate) fn a_panic_ends_power_and_restarts(image: &Description) {
    let panic = image.symbol("rust_begin_unwind");
    let end = |chip: &mut Chip| chip.jump(panic);
    ends(image, 200, end, Reset::Panic, Fault::Panic);
}

pub(crate) fn an_undefined_instruction_ends_power_and_restarts(image: &Description) {
    ends(image, 200, Chip::fault, Reset::HardFault, Fault::HardFault);
}

pub(crate) fn an_interrupt_that_nothing_handles_ends_power_and_restarts(image: &Description) {
    let handler = image.symbol("DefaultHandler");
    let end = |chip: &mut Chip| chip.jump(handler);
    ends(image, 200, end, Reset::HardFault, Fault::HardFault);
}

pub(crate) fn a_crystal_that_fails_during_the_start_is_a_clock_failure(image: &Description) {
    let mut bench = image.started();
    bench.line.chip().take_crystal();
    bench.line.chip().power_cycle();
    bench.line.chip().take_crystal();
    for _ in 0..5 {
        image.is_off_after(&mut bench, HZ / 50);
    }
    // It has set no pin up and runs no tick.
    let mut chip = bench.line.chip();
    let ticks = chip.ticks;
    chip.run(HZ / 50).expect("it runs");
    assert_eq!(chip.ticks, ticks);
}

pub(crate) fn the_watchdog_ends_a_program_that_hangs(image: &Description) {
    ends(
        image,
        BITTEN,
        Chip::hang,
        Reset::Watchdog,
        Fault::WatchdogReset,
    );
}

pub(crate) fn the_watchdog_ends_a_program_without_ticks(image: &Description) {
    let end = |chip: &mut Chip| chip.without_ticks = true;
    ends(image, BITTEN, end, Reset::Watchdog, Fault::WatchdogReset);
}

pub(crate) fn the_watchdog_ends_a_program_whose_session_hangs(image: &Description) {
    ends(
        image,
        BITTEN,
        Chip::hang_session,
        Reset::Watchdog,
        Fault::WatchdogReset,
    );
}

pub(crate) fn each_contact_of_the_emergency_stop_ends_power(image: &Description) {
    let mut bench = image.moving();
    bench.line.chip().press_stop(true);
    image.is_off_after(&mut bench, HZ / 5_000);
    assert_eq!(bench.status().fault, Some(Fault::EmergencyStop));
}

pub(crate) fn a_short_press_of_the_emergency_stop_is_latched(image: &Description) {
    let mut bench = image.moving();
    bench.line.chip().press_stop(true);
    bench.line.chip().run(150).expect("it runs");
    bench.line.chip().press_stop(false);
    image.is_off_after(&mut bench, HZ / 100);
    assert_eq!(bench.status().fault, Some(Fault::EmergencyStop));
}

pub(crate) fn the_hosts_emergency_stop_does_not_wait_for_the_session(image: &Description) {
    let mut bench = image.moving();
    let stop = frame(3, HostCommand::Request(Request::EmergencyStop));
    bench.line.chip().hang_session();
    bench.line.chip().send(&stop);
    // Before the watchdog bites.
    image.is_off_after(&mut bench, HZ / 100);
    assert_eq!(bench.line.chip().resets, 0);
}

pub(crate) fn a_fault_output_of_either_driver_ends_power(image: &Description) {
    for joint in 0..2 {
        let mut bench = image.moving();
        bench.line.chip().wires().fault[joint] = true;
        image.is_off_after(&mut bench, HZ / 1_000);
        assert_eq!(bench.status().fault, Some(Fault::DriverFault));
    }
}

pub(crate) fn a_fault_output_of_either_driver_that_stays_ends_the_waking(image: &Description) {
    for joint in 0..2 {
        let mut bench = image.started();
        bench.line.chip().wires().fault[joint] = true;
        let angles = bench.settings.axes.each_ref().map(|axis| axis.home_angle);
        bench.request(Request::SetAngles(angles)).expect("accepted");
        image.is_off_after(&mut bench, HZ / 5);
        assert_eq!(bench.status().fault, Some(Fault::DriverFault));
    }
}

/// A motion longer than the other ones is as long as it says: both joints, each its own way.
pub(crate) fn a_move_turns_both_joints_as_far_as_it_says(image: &Description) {
    let mut bench = image.armed();
    let before = place(image, &mut bench);
    go(&mut bench, [-0.05, 0.1], 0.3);
    pass(&mut bench, HZ * 4 / 5);
    let after = place(image, &mut bench);
    // A count of the servos' image is 75 cycles of a pulse.
    let per_count = if image.by_pulses { 75.0 } else { 1.0 };
    for (joint, by) in [-0.05, 0.1].into_iter().enumerate() {
        let axis = &bench.settings.axes[joint];
        let counts = by / std::f32::consts::TAU * axis.gear_ratio * axis.encoder_counts as f32;
        let made = (after[joint] - before[joint]) as f32 / per_count;
        assert!(
            (made - counts).abs() <= 1.5,
            "joint {joint}: {made} of {counts}"
        );
    }
}
