//! What keeps a board safe whatever fails: the watchdog over each task, locks, broken wires, and
//! the cause of a reset.

mod bench;

use bench::{Driven, save};
use fivebar_chip::time::{MICROSECOND, MILLISECOND};
use fivebar_chip::{Chip, Output, Pin, ResetCause};
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
fn the_flash_accelerator_is_on_with_five_wait_states() {
    let driven = Driven::new();
    let acr = driven.chip().register(0x4002_3c00).expect("a register");
    // DCEN, ICEN, PRFTEN, LATENCY.
    assert_eq!(acr & 0x707, 0x705, "{acr:#x}");
}

/// A tick begins 30 µs late, the next one is missed, and the one after it is in time: from one
/// beginning to the other it is less than two ticks.
#[test]
fn a_missed_tick_counts_though_the_one_before_was_late() {
    let mut driven = Driven::new();
    let before = driven.status().missed_ticks;
    let trigger = driven.arm.get().windows[0].expect("a sample").from;
    let at = |ticks: u64, microseconds| trigger + ticks * TICK + microseconds * MICROSECOND;
    // Not the next one, which may be nearer than the first stall begins before it.
    let next = (driven.chip().now() - trigger) / TICK + 2;
    let run_and_stall = |driven: &mut Driven, from: u64, until: u64| {
        let now = driven.chip().now();
        driven.run(from - now);
        let now = driven.chip().now();
        driven.chip().stall(until - now);
    };
    run_and_stall(&mut driven, at(next, 0) - MICROSECOND, at(next, 30));
    run_and_stall(&mut driven, at(next, 60), at(next + 2, 5));
    driven.run(10 * TICK);
    assert_eq!(driven.status().missed_ticks - before, 1);
}

#[test]
fn the_cause_of_a_reset_is_that_of_the_last_one() {
    let mut driven = Driven::new();
    for (cause, reason) in [
        (ResetCause::Watchdog, Reset::Watchdog),
        (ResetCause::BrownOut, Reset::BrownOut),
        (ResetCause::Pin, Reset::Pin),
        (ResetCause::Watchdog, Reset::Watchdog),
        (ResetCause::Power, Reset::Power),
    ] {
        driven.chip().reset(cause);
        assert_eq!(driven.reconnect(), reason);
    }
}

#[test]
fn a_press_of_the_emergency_stop_between_two_ticks_is_a_fault() {
    let mut driven = Driven::new();
    for offset in [0, 25, 50] {
        driven.arm();
        driven.run(offset * MICROSECOND);
        for pressed in [true, false] {
            driven.arm.get().press_stop(pressed);
            driven.chip().pins_changed();
            // The timer drives all four inputs low, whatever the program does.
            let low = [Output::Idle(false); 4];
            assert_eq!(driven.arm.get().outputs().pwm, low);
            driven.run(10 * MICROSECOND);
        }
        driven.run(2 * TICK);
        assert_eq!(driven.status().fault, Some(Fault::EmergencyStop));
        driven.request(Request::ClearFault).expect("cleared");
    }
}

#[test]
fn every_input_of_a_cable_has_a_resistor() {
    let mut driven = Driven::new();
    let pins = [
        (0, [0, 1, 15].as_slice()),
        (1, &[3, 7, 12]),
        (2, &[4, 5, 8, 9]),
    ];
    for (port, pins) in pins {
        for &pin in pins {
            driven.arm.get().break_wire(Pin(port, pin));
        }
    }
    driven.run(TICK);
    for (port, pins) in pins {
        let address = 0x4002_0010 + 0x400 * u32::from(port);
        let levels = driven.chip().register(address).expect("a register");
        for &pin in pins {
            assert_ne!(levels & 1 << pin, 0, "port {port}, pin {pin}");
        }
    }
    // The bridges' fault outputs are pulled down.
    let pulls = driven.chip().register(0x4002_040c).expect("a register");
    assert_eq!(pulls & 0b1111, 0b1010, "PB0 and PB1");
}

#[test]
fn the_converters_are_triggered_every_100_microseconds() {
    let mut driven = Driven::new();
    let trigger = |driven: &Driven| driven.arm.get().windows[0].expect("a sample").from;
    let before = trigger(&driven);
    driven.run(200 * MILLISECOND);
    let passed = trigger(&driven) - before;
    let off = (passed + TICK / 2) % TICK;
    assert!(off.abs_diff(TICK / 2) < MICROSECOND / 10, "{passed}");
}

#[test]
fn the_break_interrupts_the_tick_and_the_tick_interrupts_the_serial_line() {
    let driven = Driven::new();
    let priority = |interrupt: u32| {
        let word = 0xe000_e400 + (interrupt & !3);
        let word = driven.chip().register(word).expect("a register");
        word >> (8 * (interrupt & 3)) & 0xff
    };
    let [tripped, tick, receive] = [24, 18, 37].map(priority);
    assert!(
        tripped < tick && tick < receive,
        "{tripped} {tick} {receive}"
    );
    // SysTick, in the register of the system handlers.
    let system = driven.chip().register(0xe000_ed20).expect("a register");
    assert_eq!(system >> 24, tick);
}

/// Faults of drives on a bus and of steppers, which this image does not drive.
const OF_OTHER_DRIVES: [Fault; 4] = [
    Fault::DriveSilent,
    Fault::DriveError,
    Fault::BusOff,
    Fault::StepsLost,
];

/// The table names a test of this folder for each fault of this image.
#[test]
fn each_fault_has_a_test_on_this_image() {
    let table = include_str!("../../../docs/verify/data/chip_faults.csv");
    let tests = [
        include_str!("faults.rs"),
        include_str!("board_faults.rs"),
        include_str!("homing.rs"),
        include_str!("crossing.rs"),
        include_str!("reset_paths.rs"),
        include_str!("sampling.rs"),
        include_str!("broken_wires.rs"),
    ]
    .concat();
    for fault in Fault::all().filter(|fault| !OF_OTHER_DRIVES.contains(fault)) {
        let start = format!("{},", fault.number());
        let row = table.lines().find(|line| line.starts_with(&start));
        let (_, names) = row
            .and_then(|row| row.rsplit_once(','))
            .unwrap_or_else(|| panic!("no row of {fault:?}"));
        let names: Vec<_> = names.split_whitespace().collect();
        assert!(!names.is_empty(), "{fault:?}");
        for name in names {
            assert!(tests.contains(&format!("fn {name}()")), "{name}");
        }
    }
}
