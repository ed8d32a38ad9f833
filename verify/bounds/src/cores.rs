//! The cores that run images, and where their code lies.

/// What an instruction costs on a core, besides the cycles of its own: where its code lies, and what makes it wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Core {
    /// Cycles to refill the pipeline after a branch is taken, at most.
    pub(crate) refill: u64,
    /// Cycles that a line of code is waited for, and its size [bytes].
    pub(crate) wait: u64,
    pub(crate) line: u32,
    /// A branch that is taken waits for its line, after another one that was fetched ahead for nothing.
    pub(crate) jump: u64,
    /// A constant among the code waits for so many cycles, and any other access to memory, where the code waits.
    pub(crate) literal: u64,
    pub(crate) access: u64,
    /// Any access where all of them wait.
    pub(crate) register: u64,
}

/// A Cortex-M4 that runs from the flash of an STM32F405.
pub const M4_IN_FLASH: Core = Core {
    refill: 3,
    wait: 5,
    line: 16,
    jump: 2 * 5,
    // For a line of instructions on its way, and for its own.
    literal: 2 * 5,
    access: 0,
    register: 2 * 5,
};

/// A Cortex-M33 that runs from an SRAM that answers in one cycle. Arm states no cycles for the instructions of
/// this core, whose pipeline is the Cortex-M4's with a second, narrower way beside it: so those of the Cortex-M4 are taken, each at its largest.
/// Code and data share one bus, the system bus, so nothing is taken to pass at the same time: each word of code costs a
/// cycle of its own, and each access one more. A register over APB takes 3 cycles to be read and 4 to be written; 6 are taken.
pub const M33_IN_SRAM: Core = Core {
    refill: 3,
    wait: 1,
    line: 4,
    jump: 2,
    literal: 1,
    access: 1,
    register: 1 + APB,
};

/// Cycles that a register over the bridge to APB is waited for there.
pub const APB: u64 = 6;
