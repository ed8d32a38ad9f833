//! The tick and the library's solutions on a Cortex-M4F, in executed instructions.
//!
//! Runs on the emulated board under `-icount shift=0` and prints a table by semihosting;
//! `tests/data/instructions.txt` holds the table as last committed. Each line counts one
//! call, the call itself included, over the poses of one arm: mean and maximum.
//!
//! These are instructions. Cycles on silicon are more: divisions and square roots take 14,
//! loads 2, and flash has wait states.
#![no_std]
#![no_main]
#![allow(unsafe_code, reason = "the entry point's attribute exports a symbol")]

mod ours;
mod paths;
mod plain;
mod tick;

use core::hint::black_box;
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use fivebar_firmware::board::emulated::instructions::InstructionCounter;

/// Repetitions of a call: they divide the counter's step of 6 instructions.
const REPETITIONS: u32 = 84;

/// Counts `function` over `inputs`, without the instructions of the loop, and prints the result.
fn count<I: Copy, O>(
    counter: &InstructionCounter,
    name: &str,
    inputs: &[I],
    function: fn(&I) -> O,
) {
    let mut sum = 0;
    let mut most = 0;
    for input in inputs {
        let empty = repeat(counter, input, |_| ());
        let per_call = (repeat(counter, input, function) - empty + REPETITIONS / 2) / REPETITIONS;
        sum += per_call;
        most = per_call.max(most);
    }
    let mean = sum / inputs.len() as u32;
    print(name, mean, most);
}

fn print(name: &str, mean: u32, most: u32) {
    hprintln!("{:<58} {:>6} {:>6}", name, mean, most);
}

#[inline(never)]
fn repeat<I, O>(counter: &InstructionCounter, input: &I, function: impl Fn(&I) -> O) -> u32 {
    let start = counter.now();
    for _ in 0..REPETITIONS {
        black_box(function(black_box(input)));
    }
    counter.since(start)
}

#[entry]
fn main() -> ! {
    if let Some(core) = cortex_m::Peripherals::take() {
        report(&InstructionCounter::new(core.SYST));
        debug::exit(debug::EXIT_SUCCESS);
    }
    loop {
        cortex_m::asm::wfi();
    }
}

fn report(counter: &InstructionCounter) {
    let cases = ours::cases();
    hprintln!(
        "{:<58} {:>6} {:>6}",
        "instructions per call, Cortex-M4F",
        "mean",
        "max"
    );
    count(counter, "forward position", &cases, ours::forward);
    count(
        counter,
        "forward position, plainly with libm",
        &cases,
        plain::forward,
    );
    hprintln!(
        "{:<58} {:>6}",
        "forward position, RepRapFirmware 3.5 (gcc -O2)",
        500
    );
    count(
        counter,
        "inverse position, both legs",
        &cases,
        ours::inverse,
    );
    count(
        counter,
        "inverse position, both legs, plainly with libm",
        &cases,
        plain::inverse,
    );
    hprintln!(
        "{:<58} {:>6}",
        "inverse position, RepRapFirmware 3.5 (gcc -O2)",
        700
    );
    count(
        counter,
        "inverse velocities and accelerations",
        &cases,
        ours::inverse_motion,
    );
    count(
        counter,
        "forward velocities and accelerations",
        &cases,
        ours::forward_motion,
    );
    count(
        counter,
        "inverse dynamics by Kane's equations",
        &cases,
        ours::inverse_dynamics,
    );
    if let Some([line, corner, arc]) = paths::segments() {
        for (name, segment) in [
            ("reference on a line", line),
            ("reference on a rounded corner", corner),
            ("reference on an arc", arc),
        ] {
            count(counter, name, &[segment], paths::reference);
        }
    }
    for scenario in &tick::SCENARIOS {
        count_ticks(counter, scenario);
    }
}

/// Counts every tick of a scenario, one call each.
fn count_ticks(counter: &InstructionCounter, scenario: &tick::Scenario) {
    let Some(mut run) = tick::Run::new(scenario) else {
        hprintln!("the scenario was refused");
        return;
    };
    let (mut ticks, mut sum, mut most) = (0, 0, 0);
    while let Some(sample) = run.next() {
        let instructions = run.tick(counter, black_box(&sample));
        ticks += 1;
        sum += instructions;
        most = instructions.max(most);
    }
    print(scenario.name, sum / ticks.max(1), most);
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    hprintln!("panicked");
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
