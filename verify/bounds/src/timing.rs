//! What instructions cost: one each, or cycles of the Cortex-M4; [`cores`](crate::cores) has what else a core waits for.
//!
//! The cycles are those of the core's timing table (Cortex-M4 Technical Reference Manual, 3.3 and
//! table 7-1), each at its largest: a division takes 12, a taken branch refills the pipeline in 3.
//! The flash of the STM32F405 needs 5 wait states at 168 MHz and is read in lines of 16 bytes
//! (RM0090, 3.5). Its accelerator keeps lines; what it keeps cannot be known here. So there are
//! three figures: one where every line is there; one where no line of the code is, because the RAM does
//! not wait for the flash; and one where every access to data waits as well. Registers behind a bridge to a
//! slower bus wait, too: [`registers`](crate::registers) adds them.

use crate::cores::Core;
use crate::graph::{Edge, Node};

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Instructions.
    Instructions,
    /// Cycles where the flash never waits.
    CyclesWithoutWaiting,
    /// Cycles where no line of the flash is kept: the code waits, and the constants among it.
    CyclesCodeWaits,
    /// Cycles where no line of the flash is kept, and every access to data waits as well.
    CyclesWaiting,
}

/// The number of measures.
pub const MEASURES: usize = 4;

impl Measure {
    /// All measures.
    pub const ALL: [Self; MEASURES] = [
        Self::Instructions,
        Self::CyclesWithoutWaiting,
        Self::CyclesCodeWaits,
        Self::CyclesWaiting,
    ];

    /// The cost of an instruction on a core, without those that it calls.
    pub fn node(self, core: Core, node: &Node) -> u64 {
        let instruction = &node.instruction;
        // A call and a return are branches, which have no edge in the function's own graph.
        let branches = u64::from(node.leaves) + 2 * u64::from(!node.calls.is_empty());
        let cycles = u64::from(instruction.cycles) + branches * core.refill;
        let last = node.address + instruction.length - 1;
        let begins_line = node.address.is_multiple_of(core.line);
        let lines = last / core.line - node.address / core.line + u32::from(begins_line);
        let code = branches * core.jump + u64::from(lines) * core.wait;
        let (accesses, literals) = (
            u64::from(instruction.accesses),
            u64::from(instruction.literals),
        );
        match self {
            Self::Instructions => 1,
            Self::CyclesWithoutWaiting => cycles,
            Self::CyclesCodeWaits => {
                cycles + code + literals * core.literal + (accesses - literals) * core.access
            }
            Self::CyclesWaiting => cycles + code + accesses * core.register,
        }
    }

    /// The cost of an edge between two instructions.
    pub fn edge(self, core: Core, edge: Edge) -> u64 {
        match self {
            Self::CyclesWithoutWaiting if edge.taken => core.refill,
            Self::CyclesCodeWaits | Self::CyclesWaiting if edge.taken => core.refill + core.jump,
            _ => 0,
        }
    }

    /// Entry into an exception and return from it. The FPU's registers are saved at the handler's first
    /// instruction of the FPU (lazy stacking, which the core has on after a reset), and restored at its
    /// return if there was one.
    pub fn exception(self, core: Core, float: bool) -> u64 {
        let frame = if float { FRAME + FLOAT_FRAME } else { FRAME };
        match self {
            Self::Instructions => 0,
            Self::CyclesWithoutWaiting => 2 * frame,
            // The handler's address is read where the code is; the first line and that returned to.
            Self::CyclesCodeWaits | Self::CyclesWaiting => {
                2 * frame * (1 + core.access) + core.literal + 2 * core.jump
            }
        }
    }
}

/// Cycles to save or to restore the registers, and those of the FPU.
const FRAME: u64 = 12;
const FLOAT_FRAME: u64 = 17;
