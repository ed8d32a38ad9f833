//! How much of the stack has been in use.
//!
//! The start-up code paints it (`paint-stack` of cortex-m-rt); what is not paint any more
//! has been written to since, by the program or by an interrupt. `memory.x` puts the stack
//! below everything else, so that one that outgrows its place leaves the RAM, which is a
//! fault of the processor, and does not run into the variables.

use crate::protocol::StackUse;
use cortex_m_rt::STACK_PAINT_VALUE;

#[allow(unsafe_code)]
unsafe extern "C" {
    /// The borders of the stack, by the linker script; it grows from the start down.
    static _stack_start: u32;
    static _stack_end: u32;
}

/// What has been used since the reset. Reads the unused part, word by word: 16384 words at
/// most.
pub fn used() -> StackUse {
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let size = (start as usize - end as usize) as u32;
    let words = size as usize / size_of::<u32>();
    let painted = (0..words)
        // SAFETY: within the stack's own memory, of which the words below the stack pointer
        // are nobody's.
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
