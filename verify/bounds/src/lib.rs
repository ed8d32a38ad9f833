//! Bounds of time and stack, from the machine code of a linked image.
//!
//! ```text
//! image       ELF file: code, functions, data among the code, vector table
//!   │  narrow, wide, float: one instruction
//! graph       control-flow graph of a function
//!   │
//!   ├─ blocking  critical sections, which keep an interrupt waiting
//!   ├─ longest   longest path, in instructions and in cycles (timing)
//!   ├─ depth     deepest stack
//! program     both over all functions that one calls; recursion, indirect calls
//!   │  stated    bounds of loops and targets of calls that people stated
//! report      the interrupts of an image
//!   │
//! response    from the converter's trigger to the end of the tick's interrupt
//! ```
//!
//! The longest path is that of the graph. It may pass branches that no input takes together, so
//! the true maximum can be smaller, and never larger. `docs/verify/bounds.md` states what this relies on.

pub mod blocking;
pub mod cores;
pub mod depth;
pub mod document;
pub mod families;
mod float;
pub mod graph;
pub mod image;
pub mod instruction;
pub mod longest;
pub mod narrow;
pub mod program;
pub mod registers;
pub mod report;
pub mod response;
pub mod stated;
pub mod timing;
pub mod wide;

use core::fmt;

/// Something in a function that keeps its time or its stack from being bounded.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Defect {
    /// Name of the function.
    pub function: String,
    /// Where in it.
    pub address: u32,
    /// What it is.
    pub fault: Fault,
}

/// What keeps time or stack from being bounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// A call through a register, whose targets are not stated.
    IndirectCall,
    /// A jump to a computed address.
    ComputedJump,
    /// A jump table whose targets are not all in the function.
    JumpTable,
    /// An instruction that the decoder does not know, or code outside the function.
    UnknownInstruction,
    /// A jump to an address that is not the beginning of a function.
    NoFunction(u32),
    /// The core waits for an event.
    Sleep,
    /// A function that can call itself.
    Recursion,
    /// A loop without a stated bound.
    Loop,
    /// A loop with several entries.
    LoopEntries,
    /// The stack pointer changes by an amount that is not known.
    UnknownStack,
    /// The stack pointer rises above its place at the entry.
    StackAboveEntry,
    /// A function that is not in the SRAM, where all of the image runs.
    OutsideSram(u32),
    /// Two paths to one instruction have different depths of the stack [bytes].
    StackDiffers(u32, u32),
    /// A critical section has no end that can be known.
    SectionEnd,
    /// It should run for ever, or end the program, and can return.
    Returns,
    /// The function returns and leaves so many bytes on the stack.
    StackAtReturn(u32),
}

impl Fault {
    /// Whether it makes the depth of the stack unknown too, and not the time alone.
    pub fn concerns_stack(self) -> bool {
        !matches!(
            self,
            Self::Sleep | Self::Loop | Self::LoopEntries | Self::SectionEnd | Self::OutsideSram(_)
        )
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {:#x}: {}", self.function, self.address, self.fault)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IndirectCall => f.write_str("an indirect call whose targets are not stated"),
            Self::ComputedJump => f.write_str("a jump to a computed address"),
            Self::JumpTable => f.write_str("a jump table that cannot be followed"),
            Self::UnknownInstruction => f.write_str("an instruction that is not known"),
            Self::NoFunction(address) => {
                write!(f, "{address:#x} is not the beginning of a function")
            }
            Self::Sleep => f.write_str("the core waits for an event"),
            Self::Recursion => f.write_str("the function can call itself"),
            Self::Loop => f.write_str("a loop without a stated bound"),
            Self::LoopEntries => f.write_str("a loop with several entries"),
            Self::UnknownStack => f.write_str("the stack pointer changes by an unknown amount"),
            Self::StackAboveEntry => f.write_str("the stack pointer rises above its first place"),
            Self::StackDiffers(one, other) => {
                write!(
                    f,
                    "the stack is {one} or {other} bytes deep, by the path there"
                )
            }
            Self::OutsideSram(address) => {
                write!(f, "the function at {address:#x} is not in the SRAM")
            }
            Self::SectionEnd => f.write_str("a critical section whose end is not known"),
            Self::Returns => f.write_str("it should never return, and can"),
            Self::StackAtReturn(bytes) => write!(f, "{bytes} bytes are left on the stack"),
        }
    }
}
