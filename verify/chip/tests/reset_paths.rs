//! Ways in which a program ends: each leaves the bridges off at once, and a reason and a latched
//! fault that the host reads after the restart.

mod bench;

use bench::raised::stays_off_until_cleared;
use bench::{Driven, image};
use fivebar_chip::time::{MICROSECOND, MILLISECOND};
use fivebar_chip::{Chip, ResetCause};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::Reset;
use fivebar_firmware::safety::Fault;

/// The bridges are off within 10 µs of `end`, and the restarted program gives this reason and
/// latches this fault. Nothing moves until it is cleared, and then the arm must be homed again
/// before it can be armed.
#[track_caller]
fn ends(reason: Reset, fault: Option<Fault>, end: impl FnOnce(&mut Chip)) {
    let mut driven = Driven::new();
    driven.arm();
    // To some 50 µs behind a tick's begin: one that begins at the same time would be done first.
    while !driven.chip().function().contains("controller4tick") {
        driven.run(MICROSECOND);
    }
    driven.run(50 * MICROSECOND);
    end(&mut driven.chip());
    driven.run(10 * MICROSECOND);
    assert!(driven.is_off());
    assert_eq!(driven.reconnect(), reason);
    assert_eq!(driven.chip().resets().len(), 2);
    if let Some(fault) = fault {
        stays_off_until_cleared(&mut driven, fault);
    }
    assert_eq!(driven.status().fault, None);
    assert!(driven.request(Request::Arm).is_err());
    driven.run(20 * MILLISECOND);
    assert!(driven.is_off_twice());
}

/// An address in RAM with an instruction that the processor does not have.
const UNDEFINED: u32 = 0x2001_f000;

#[test]
fn a_panic() {
    let (panic, _) = image()
        .symbol("rust_begin_unwind")
        .expect("a panic handler");
    ends(Reset::Panic, Some(Fault::Panic), |chip| {
        chip.go_on_at(panic)
    });
}

#[test]
fn an_undefined_instruction() {
    ends(Reset::HardFault, Some(Fault::HardFault), |chip| {
        chip.write_ram_word(UNDEFINED, 0xde00_de00);
        chip.go_on_at(UNDEFINED);
    });
}

#[test]
fn a_stack_at_its_end() {
    let mut driven = Driven::new();
    driven.arm();
    driven.chip().leave_stack(64);
    driven.run(110 * MICROSECOND);
    assert!(driven.is_off());
    assert_eq!(driven.reconnect(), Reset::HardFault);
    assert_eq!(driven.status().fault, Some(Fault::HardFault));
}

#[test]
fn an_interrupt_that_nothing_handles() {
    ends(Reset::HardFault, Some(Fault::HardFault), |chip| {
        chip.raise_interrupt(0);
    });
}

#[test]
fn a_brown_out() {
    ends(Reset::BrownOut, Some(Fault::BrownOut), |chip| {
        chip.reset(ResetCause::BrownOut);
    });
}

#[test]
fn the_reset_pin() {
    ends(Reset::Pin, Some(Fault::UnexpectedReset), |chip| {
        chip.reset(ResetCause::Pin);
    });
}

#[test]
fn a_reset_by_software_without_a_note() {
    ends(Reset::Software, Some(Fault::UnexpectedReset), |chip| {
        chip.reset(ResetCause::Software);
    });
}

#[test]
fn a_low_power_mode_that_no_program_here_enters() {
    ends(Reset::Unknown, Some(Fault::UnexpectedReset), |chip| {
        chip.reset(ResetCause::LowPower);
    });
}

#[test]
fn a_note_names_the_cause_of_one_reset_only() {
    let (panic, _) = image()
        .symbol("rust_begin_unwind")
        .expect("a panic handler");
    let mut driven = Driven::new();
    driven.chip().go_on_at(panic);
    assert_eq!(driven.reconnect(), Reset::Panic);
    driven.chip().reset(ResetCause::Software);
    assert_eq!(driven.reconnect(), Reset::Software);
}

#[test]
fn a_loss_of_power() {
    ends(Reset::Power, None, |chip| chip.reset(ResetCause::Power));
}

#[test]
fn a_bite_of_the_watchdog() {
    ends(Reset::Watchdog, Some(Fault::WatchdogReset), |chip| {
        chip.reset(ResetCause::Watchdog);
    });
}
