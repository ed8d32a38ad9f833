//! How the program ends, and why the chip started: a note in the watchdog's first scratch register, which only a loss of power
//! and the reset pin clear.

use super::pulses;
use super::watchdog;
use crate::board::end_cause::EndCause;
use crate::protocol::Reset;
use rp235x_pac::{POWMAN, PSM, WATCHDOG};

/// Ends the pulses, from any context and in any state, leaves the note and resets the chip.
pub fn end(cause: EndCause) -> ! {
    pulses::end();
    // SAFETY: nothing else runs on. The brake's and the tool's pins float after the reset.
    #[allow(unsafe_code)]
    let (watchdog, psm) = unsafe { (&*WATCHDOG::ptr(), &*PSM::ptr()) };
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
