//! The last frames, in a panic or a fault of the processor: no torque, to both drives.
//!
//! The handlers own no peripheral and know no settings, so the frames lie ready in memory. If they do not arrive, the drives
//! get no more commands, and their own watchdogs end the torque.

use super::bxcan::{self, Words};
use crate::board::end_cause::EndCause;
use crate::board::stm32f405::post_mortem::reset_after;
use crate::drives::can::Frame;
use core::sync::atomic::{AtomicU32, Ordering};

/// The frames' words; all 0 where no drives are known.
static STOPS: [[AtomicU32; 4]; 2] = [const { [const { AtomicU32::new(0) }; 4] }; 2];
/// How often the mailboxes are looked at: a frame that is on its way and two of 0.135 ms each are over after 0.4 ms, and
/// one look takes 5 cycles at least.
const TIMEOUT_READS: u32 = 20_000;

/// The frames from now on.
pub fn prepare(frames: [Frame; 2]) {
    for (place, frame) in STOPS.iter().zip(frames) {
        for (place, word) in place.iter().zip(bxcan::words(&frame)) {
            place.store(word, Ordering::Relaxed);
        }
    }
}

/// Sends them, waits until they have gone over the bus, or for so long as that can take, and resets the chip.
pub fn end(cause: EndCause) -> ! {
    cortex_m::interrupt::disable();
    // SAFETY: nothing else runs any more.
    #[allow(unsafe_code)]
    let can = unsafe { bxcan::registers() };
    bxcan::abort(can);
    for place in &STOPS {
        let words: Words = place.each_ref().map(|word| word.load(Ordering::Relaxed));
        let [_, length, ..] = words;
        if length > 0 {
            // A mailbox is free at last when the frame in it is over, or is taken back.
            let _ = (0..TIMEOUT_READS).any(|_| bxcan::put(can, words));
        }
    }
    let _ = (0..TIMEOUT_READS).any(|_| bxcan::is_empty(can));
    reset_after(cause)
}
