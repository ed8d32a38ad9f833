//! Why a program ended, as a note that outlives the reset.

use crate::protocol::Reset;

/// Why the program ended. The numbers are the notes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndCause {
    /// By a panic.
    Panic = 0x5041_4e21,
    /// By a hard fault.
    HardFault = 0x4641_5521,
}

impl EndCause {
    /// The note.
    pub const fn mark(self) -> u32 {
        self as u32
    }

    /// The reason of a reset that the program itself has made, by the note that it left.
    pub const fn reset(note: u32) -> Reset {
        const PANIC: u32 = EndCause::Panic.mark();
        const HARD_FAULT: u32 = EndCause::HardFault.mark();
        match note {
            PANIC => Reset::Panic,
            HARD_FAULT => Reset::HardFault,
            _ => Reset::Software,
        }
    }
}
