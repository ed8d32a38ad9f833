//! Ways in which a program ends: each leaves the bridges off at once, and a reason that the host
//! reads after the restart.

mod bench;

use bench::{Driven, image};
use fivebar_chip::time::{MICROSECOND, MILLISECOND};
use fivebar_chip::{Chip, ResetCause};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::Reset;
use fivebar_firmware::safety::State;

/// The bridges are off within 10 µs of `end`, and the restarted program gives this reason. The
/// arm must be homed again before it can be armed.
#[track_caller]
fn ends(reason: Reset, end: impl FnOnce(&mut Chip)) {
    let mut driven = Driven::new();
    driven.arm();
    end(&mut driven.chip());
    driven.run(10 * MICROSECOND);
    assert!(driven.is_off());
    assert_eq!(driven.reconnect(), reason);
    assert_eq!(driven.chip().resets().len(), 2);
    assert_ne!(driven.status().state, State::Armed);
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
    ends(Reset::Panic, |chip| chip.go_on_at(panic));
}

#[test]
fn an_undefined_instruction() {
    ends(Reset::HardFault, |chip| {
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
}

#[test]
fn an_interrupt_that_nothing_handles() {
    ends(Reset::HardFault, |chip| chip.raise_interrupt(0));
}

#[test]
fn a_brown_out() {
    ends(Reset::BrownOut, |chip| chip.reset(ResetCause::BrownOut));
}

#[test]
fn the_reset_pin() {
    ends(Reset::Power, |chip| chip.reset(ResetCause::Pin));
}

#[test]
fn a_loss_of_power() {
    ends(Reset::Power, |chip| chip.reset(ResetCause::Power));
}

#[test]
fn a_bite_of_the_watchdog() {
    ends(Reset::Watchdog, |chip| chip.reset(ResetCause::Watchdog));
}
