//! When the currents are sampled: in the bridges' braking phase, between the edges of their outputs,
//! which come later than those of their inputs. See *Sampling* in `docs/use/wiring.md`.

mod bench;

use bench::raised::{TICK, at_the_end, moving};
use bench::{Bench, Driven};
use fivebar_chip::time::{MICROSECOND, MILLISECOND, Time};
use fivebar_chip::{BRIDGE_DELAYS, Options, RepetitionReading};
use fivebar_firmware::Request;
use fivebar_firmware::controller::{Excitation, Excited};
use fivebar_firmware::safety::Fault;

#[test]
fn the_converter_samples_in_the_middle_of_the_braking_phase() {
    let mut driven = Driven::new();
    driven.arm();
    driven.run(20 * MILLISECOND);
    assert_eq!(driven.arm.get().samples_on_edges, 0);
    assert_eq!(driven.chip().counter_at_last_trigger(), Some(0));
}

#[test]
fn a_converter_triggered_in_the_drive_pulse_keeps_the_arm_off() {
    let bench = Bench::with(Options::default(), Vec::new(), 0);
    let reading = RepetitionReading::BySentence;
    bench.line.chip().read_repetitions(reading);
    let mut driven = bench.connect();
    driven.run(10 * MILLISECOND);
    assert_ne!(driven.chip().counter_at_last_trigger(), Some(0));
    assert_eq!(driven.status().fault, Some(Fault::ClockFailure));
    assert!(driven.request(Request::Arm).is_err());
    driven.request(Request::ClearFault).expect("cleared");
    driven.run(2 * TICK);
    assert_eq!(driven.status().fault, Some(Fault::ClockFailure));
}

/// The longest blocking that the firmware's bounds allow.
const BLOCKING: Time = 5 * MICROSECOND;
/// By how much the time of the encoders' counts may differ from tick to tick: a hundredth of a microsecond.
const LATCH_JITTER: Time = MICROSECOND / 100;

#[test]
fn nothing_that_blocks_the_tick_shifts_the_latch_of_the_encoders() {
    let mut driven = moving();
    driven.chip().latched_after();
    let mut random = 1_u64;
    for tick in 0..1000 {
        // Knuth's generator: the core stands still for a while somewhere in each tick.
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        driven.run(TICK - BLOCKING + (random >> 40) % (2 * BLOCKING));
        driven.chip().stall((random >> 20) % BLOCKING);
        if tick % 50 == 0 {
            driven.status();
        }
    }
    assert_eq!(driven.status().fault, None);
    let [least, greatest] = driven.chip().latched_after().expect("counts");
    println!("latched {least} to {greatest} fs after the trigger");
    assert!(greatest < MICROSECOND, "{greatest} fs after the trigger");
    assert!(greatest - least <= LATCH_JITTER, "{least} to {greatest} fs");
}

#[test]
fn both_currents_are_sampled_at_once_and_held_after_the_edges_have_settled() {
    let mut driven = Driven::new();
    driven.arm();
    let windows = driven.arm.get().windows;
    let [current1, current4, bus] = windows.map(|window| window.expect("a sample"));
    assert_eq!(
        (current1.from, current1.until),
        (current4.from, current4.until)
    );
    let length = current1.until - current1.from;
    assert!(
        (MICROSECOND..MICROSECOND * 3 / 2).contains(&length),
        "{length}"
    );
    // The bus voltage's filter needs this time to settle.
    assert!(bus.from > current1.until && bus.until - bus.from > MICROSECOND / 2);
}

#[test]
fn no_edge_of_a_quick_or_a_slow_bridge_changes_a_sample_at_the_greatest_duty() {
    for delay in BRIDGE_DELAYS {
        for (joint, offset) in [(0, 24.0), (1, -24.0)] {
            // An excitation's voltage is bounded by what drives twice its current at rest.
            let mut driven = at_the_end(Options::default())
                .ready_with(|settings| settings.axes[usize::from(joint)].resistance = 10.0);
            driven.arm.get().bridge_delay = delay;
            let hard = Excitation {
                joint,
                of: Excited::Voltage,
                offset,
                amplitude: 0.0,
                hold: 1,
                ticks: 100,
                current: 1.2,
                travel: 1.0,
            };
            driven.request(Request::Excite(hard)).expect("driven");
            driven.run(20 * MILLISECOND);
            let arm = driven.arm.get();
            let duties = arm
                .ticks
                .iter()
                .map(|tick| tick.duty[usize::from(joint)].abs());
            // Of 4200 counts.
            let greatest = duties.max();
            assert_eq!(greatest, Some(3990), "joint {joint}");
            assert_eq!(arm.samples_on_edges, 0, "{delay}, joint {joint}");
        }
    }
}
