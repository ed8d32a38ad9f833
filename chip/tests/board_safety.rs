//! What keeps a board safe whatever fails: the watchdog over each task, locks, broken wires, and
//! the cause of a reset.

mod bench;

use bench::{Driven, save};
use fivebar_chip::time::{MICROSECOND, MILLISECOND};
use fivebar_chip::{Chip, Pin, ResetCause};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::{Reply, Reset};
use fivebar_firmware::safety::Fault;

/// A tick.
const TICK: u64 = 100 * MICROSECOND;

#[test]
fn the_watchdog_bites_when_one_task_stops_though_the_other_goes_on() {
    let stops: [fn(&mut Chip); 2] = [
        // The tick: the converters' interrupt.
        |chip| chip.disable_interrupt(18),
        // The session: an endless loop, with interrupts.
        |chip| {
            chip.write_ram_word(0x2001_f000, 0xe7fe_e7fe);
            chip.go_on_at(0x2001_f000);
        },
    ];
    for (number, stop) in stops.iter().enumerate() {
        let mut driven = Driven::new();
        driven.arm();
        stop(&mut driven.chip());
        driven.run(120 * MILLISECOND);
        let (_, cause) = *driven.chip().resets().last().expect("a reset");
        assert_eq!(cause, ResetCause::Watchdog, "task {number}");
    }
}

#[test]
fn the_break_and_the_flash_are_locked() {
    let mut driven = Driven::new();
    assert_eq!(save(&mut driven), Reply::Done);
    let read = |address| driven.chip().register(address).expect("a register");
    let (bdtr, cr, optcr) = (read(0x4001_0044), read(0x4002_3c10), read(0x4002_3c14));
    assert_ne!(bdtr & 0x300, 0, "LOCK of TIM1_BDTR");
    assert_ne!(cr & 1 << 31, 0, "LOCK of FLASH_CR");
    assert_eq!(cr & 7, 0, "no operation is set up in FLASH_CR");
    assert_ne!(optcr & 1, 0, "OPTLOCK of FLASH_OPTCR");
}

#[test]
fn a_broken_wire_reads_as_the_unsafe_case() {
    let mut driven = Driven::new();
    driven.arm();
    driven.arm.get().break_wire(Pin(1, 12));
    driven.chip().pins_changed();
    driven.run(2 * TICK);
    assert!(driven.is_off());
    assert_eq!(driven.status().fault, Some(Fault::EmergencyStop));
    // A home switch that is always pressed cannot be left: homing fails.
    let mut driven = Driven::new();
    driven.arm.get().break_wire(Pin(2, 4));
    driven.request(Request::Home).expect("homing");
    for _ in 0..200 {
        driven.run(20 * MILLISECOND);
        if driven.status().fault.is_some() {
            break;
        }
    }
    assert_eq!(driven.status().fault, Some(Fault::Envelope));
}

#[test]
fn the_cause_of_a_reset_is_that_of_the_last_one() {
    let mut driven = Driven::new();
    for (cause, reason) in [
        (ResetCause::Watchdog, Reset::Watchdog),
        (ResetCause::BrownOut, Reset::BrownOut),
        (ResetCause::Pin, Reset::Power),
        (ResetCause::Watchdog, Reset::Watchdog),
        (ResetCause::Power, Reset::Power),
    ] {
        driven.chip().reset(cause);
        assert_eq!(driven.reconnect(), reason);
    }
}
