//! Instructions of the FPU; times from the Cortex-M4's Technical Reference Manual, table 7-1.
//!
//! The result of an arithmetic instruction is ready one cycle later for another one. This cycle
//! is added to each.

use crate::instruction::{Instruction, PC, SP, Stack};

/// The cycle that a result may be waited for.
const RESULT: u32 = 1;

/// The instruction of the halfwords `high` and `low`, one of a coprocessor.
pub(crate) fn decode(high: u32, low: u32) -> Instruction {
    Instruction {
        float: true,
        ..of_coprocessor(high, low)
    }
}

fn of_coprocessor(high: u32, low: u32) -> Instruction {
    // Coprocessors 10 and 11 are the FPU.
    if low & 0x0E00 != 0x0A00 {
        return Instruction::unknown();
    }
    let plain = Instruction::plain(4);
    // The second half of the space is ARMv8-M's: VSEL, VMAXNM, VMINNM, VRINT, VCVT between registers.
    if high & 0x1000 != 0 {
        return if high & 0xFF00 == 0xFE00 {
            plain.cycles(RESULT + 1)
        } else {
            Instruction::unknown()
        };
    }
    match high & 0x0300 {
        0x0300 => Instruction::unknown(),
        // Between the FPU and one of the core's registers; VMRS moves the flags.
        0x0200 if low & 0x10 != 0 => plain.sets_flags(high & 0xFFF0 == 0xEEF0),
        0x0200 => plain.cycles(RESULT + arithmetic(high, low)),
        // Between the FPU and two of the core's registers.
        _ if high & 0x01E0 == 0x0040 => plain.cycles(2),
        _ => memory(high, low),
    }
}

fn arithmetic(high: u32, low: u32) -> u32 {
    // The bit 0x40 is part of a register's number.
    match high & 0xB0 {
        // Products that are added: VMLA, VMLS, VNMLA, VNMLS, VFNMA, VFNMS, VFMA, VFMS.
        0x00 | 0x10 | 0x90 | 0xA0 => 3,
        // VDIV, VSQRT.
        0x80 => 14,
        0xB0 if high & 0xF == 1 && low & 0xC0 == 0xC0 => 14,
        _ => 1,
    }
}

/// Loads and stores of one register or several.
fn memory(high: u32, low: u32) -> Instruction {
    let words = low & 0xFF;
    let (indexed, up) = (high & 0x100 != 0, high & 0x80 != 0);
    let (writes_back, load) = (high & 0x20 != 0, high & 0x10 != 0);
    let plain = Instruction::plain(4);
    if indexed && !writes_back {
        // A register of 64 bits has the coprocessor 11.
        return plain
            .accesses(1 + (low >> 8 & 1))
            .literals(high & 0xF == PC);
    }
    let stack = match (high & 0xF == SP && writes_back, up, load) {
        (false, ..) => Stack::Keep,
        (true, false, false) => Stack::Push(4 * words),
        (true, true, true) => Stack::Pop(4 * words),
        _ => Stack::Unknown,
    };
    plain.accesses(words).stack(stack)
}
