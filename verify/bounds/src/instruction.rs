//! What the analysis needs to know of one instruction.

/// The number of the stack pointer's register.
pub(crate) const SP: u32 = 13;
/// The number of the program counter's register.
pub(crate) const PC: u32 = 15;

/// One machine instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// 2 or 4 [bytes].
    pub length: u32,
    /// Where the program goes from here.
    pub flow: Flow,
    /// What it does to the stack pointer.
    pub stack: Stack,
    /// Cycles by the core's timing table, without refilling the pipeline after a branch.
    pub cycles: u32,
    /// Accesses to memory over the data bus, one for each register that is read or written.
    pub accesses: u32,
    /// How many of the accesses read constants that lie among the code.
    pub literals: u32,
    /// It may change the flags that conditional instructions test.
    pub sets_flags: bool,
    /// What it does to the masks of interrupts.
    pub mask: Mask,
    /// It is one of the FPU.
    pub float: bool,
}

/// Where the program goes after an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// To the next instruction.
    Next,
    /// To this address.
    Jump(u32),
    /// To this address or to the next instruction.
    Branch(u32),
    /// Into the function at this address, which returns to the next instruction.
    Call(u32),
    /// Into a function whose address is in a register.
    CallRegister,
    /// Back to the caller.
    Return,
    /// To one of the addresses in a table, whose entries have one or two bytes.
    Table {
        /// Size of an entry [bytes].
        entry: u32,
        /// The register with the table's address; none: it is behind the instruction.
        base: Option<u32>,
    },
    /// To one of the long jumps behind the instruction, whose address is in a register.
    Jumps,
    /// To an address that is computed in another way.
    Computed,
    /// To the next instruction, at an unknown time: the core sleeps.
    Sleep,
    /// Nowhere: the core takes a fault.
    Trap,
    /// To up to four instructions that are executed under a condition or its opposite.
    IfThen {
        /// Number of instructions.
        slots: u8,
        /// Bit i: instruction i is executed if the condition holds; else if it does not.
        senses: u8,
        /// The condition's number: the last bit inverts it, 14 always holds.
        condition: u8,
    },
    /// The decoder does not know this instruction.
    Unknown,
}

/// What an instruction does to the stack pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stack {
    /// Nothing.
    Keep,
    /// Moves it down by so many bytes.
    Push(u32),
    /// Moves it up by so many bytes.
    Pop(u32),
    /// The main stack pointer is loaded anew: the stack begins again.
    Restart,
    /// Changes it by an amount that the instruction does not tell, or sets it from a register.
    Unknown,
}

/// What an instruction does to BASEPRI, PRIMASK or FAULTMASK, which keep interrupts waiting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mask {
    /// Nothing.
    Keep,
    /// Raises one.
    Raise,
    /// Writes what was read before it was raised.
    Restore,
    /// Lets all interrupts through, whatever was before.
    Open,
}

impl Instruction {
    /// An instruction of `length` bytes that takes one cycle and does nothing else of interest.
    pub(crate) fn plain(length: u32) -> Self {
        Self {
            length,
            flow: Flow::Next,
            stack: Stack::Keep,
            cycles: 1,
            accesses: 0,
            literals: 0,
            sets_flags: false,
            mask: Mask::Keep,
            float: false,
        }
    }

    /// A wide instruction that the analysis does not know.
    pub(crate) fn unknown() -> Self {
        Self::plain(4).flow(Flow::Unknown)
    }

    pub(crate) fn flow(self, flow: Flow) -> Self {
        Self { flow, ..self }
    }

    pub(crate) fn stack(self, stack: Stack) -> Self {
        Self { stack, ..self }
    }

    pub(crate) fn cycles(self, cycles: u32) -> Self {
        Self { cycles, ..self }
    }

    /// It reads or writes `n` registers in memory: one cycle, and one for each.
    pub(crate) fn accesses(self, n: u32) -> Self {
        Self {
            cycles: 1 + n,
            accesses: n,
            ..self
        }
    }

    /// Its accesses read constants that lie among the code, if `among_code`.
    pub(crate) fn literals(self, among_code: bool) -> Self {
        let literals = if among_code { self.accesses } else { 0 };
        Self { literals, ..self }
    }

    pub(crate) fn sets_flags(self, sets_flags: bool) -> Self {
        Self { sets_flags, ..self }
    }

    pub(crate) fn mask(self, mask: Mask) -> Self {
        Self { mask, ..self }
    }
}
