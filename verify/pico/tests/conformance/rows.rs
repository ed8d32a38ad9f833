//! The rows: what every image must do, as `verify/chip` has it for those of the first board.

use crate::bench::{Bench, frame};
use crate::images::{BITTEN, Description, go};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::{HostCommand, Reset};
use fivebar_firmware::safety::Fault;
use fivebar_pico::{Chip, HZ};

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

/// Steps that were made, and the lengths of the last pulses.
fn place(bench: &mut Bench) -> ([i32; 2], [u64; 2]) {
    let mut chip = bench.line.chip();
    let wires = chip.wires();
    let last = [0, 1].map(|joint| {
        let of_joint = wires.pulses.iter().rev().find(|pulse| pulse.joint == joint);
        of_joint.map_or(0, |pulse| pulse.cycles)
    });
    (wires.edges, last)
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
    let (edges, pulses) = place(&mut bench);
    go(&mut bench, [-0.05, 0.1], 0.3);
    bench.line.chip().run(HZ).expect("it ends");
    let (edges_after, pulses_after) = place(&mut bench);
    let settings = bench.settings;
    for (joint, by) in [-0.05, 0.1].into_iter().enumerate() {
        let axis = &settings.axes[joint];
        let counts = by / std::f32::consts::TAU * axis.gear_ratio * axis.encoder_counts as f32;
        let made = if settings.check().expect("valid").servo_pulses().is_some() {
            (pulses_after[joint] as f32 - pulses[joint] as f32) / 75.0
        } else {
            (edges_after[joint] - edges[joint]) as f32
        };
        assert!(
            (made - counts).abs() <= 1.5,
            "joint {joint}: {made} of {counts}"
        );
    }
}
