//! How the program ends, and why the chip started: a note in the watchdog's first scratch register, which only a loss of power
//! and the reset pin clear.

use super::stepper::pins::ENABLE;
use super::{resets, watchdog};
use crate::board::end_cause::EndCause;
use crate::protocol::Reset;
use rp235x_pac::{POWMAN, PSM, WATCHDOG};

/// RESET in the addresses that set bits.
pub const RESET_SET: u32 = 0x4002_2000;
/// The levels of the core's outputs, in the address that sets bits.
pub const OUTPUTS_HIGH: u32 = 0xd000_0018;
/// The enables of stepper drivers, high without power. No output of the image for servos.
pub const ENABLES: u32 = 1 << ENABLE[0] | 1 << ENABLE[1];

/// Ends the pulses and takes the drivers' power until the next reset of the chip, by two writes, leaves the note and resets the
/// chip. From any context and in any state. PIO0 in reset drives no pin; the resistors keep them low.
pub fn end(cause: EndCause) -> ! {
    // SAFETY: the writes only switch off, and nothing runs on that takes them back. The brake's and the tool's pins float after
    // the reset.
    #[allow(unsafe_code)]
    let (watchdog, psm) = unsafe {
        (OUTPUTS_HIGH as *mut u32).write_volatile(ENABLES);
        (RESET_SET as *mut u32).write_volatile(resets::PIO0);
        (&*WATCHDOG::ptr(), &*PSM::ptr())
    };
    // SAFETY: any 32 bits are a note.
    #[allow(unsafe_code)]
    watchdog
        .scratch0()
        .write(|w| unsafe { w.bits(cause.mark()) });
    watchdog::force(watchdog, psm);
    loop {
        cortex_m::asm::nop();
    }
}

/// Why the chip started. Clears the note.
pub fn reset_reason(watchdog: &WATCHDOG, powman: &POWMAN) -> Reset {
    let note = watchdog.scratch0().read().bits();
    watchdog.scratch0().reset();
    let reason = watchdog.reason().read();
    let chip = powman.chip_reset().read();
    if reason.force().bit_is_set() {
        EndCause::reset(note)
    } else if reason.timer().bit_is_set() {
        Reset::Watchdog
    } else if chip.had_por().bit_is_set() {
        Reset::Power
    } else if chip.had_bor().bit_is_set() {
        Reset::BrownOut
    } else if chip.had_run_low().bit_is_set() {
        Reset::Pin
    } else {
        Reset::Unknown
    }
}
