//! How much of the stack has been in use.
//!
//! The start-up code fills the stack with a pattern (`paint-stack` of cortex-m-rt); the program
//! and its interrupts overwrite it. `memory.x` puts the stack below everything else, so that a
//! stack that overflows leaves the RAM, which raises a processor fault, and overwrites no
//! variables.

use crate::protocol::StackUse;
use cortex_m_rt::STACK_PAINT_VALUE;

#[allow(unsafe_code)]
unsafe extern "C" {
    /// The ends of the stack, from the linker script; it grows from the start down.
    static _stack_start: u32;
    static _stack_end: u32;
}

/// How much has been used since the reset. Reads the unused part word by word: at most 16384
/// words.
pub fn used() -> StackUse {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let size = (start as usize - end as usize) as u32;
    let words = size as usize / size_of::<u32>();
    let painted = (0..words)
        // SAFETY: within the stack's memory; nothing uses the words below the stack pointer.
        .take_while(|&word| {
            #[allow(unsafe_code)]
            let word = unsafe { end.add(word).read_volatile() };
            word == STACK_PAINT_VALUE
        })
        .count();
    StackUse {
        most: size - (painted * size_of::<u32>()) as u32,
        size,
    }
}
