//! Instructions of 32 bits, without those of the FPU. References are to the ARMv7-M Architecture
//! Reference Manual, A5.3.

use crate::float;
use crate::instruction::{Flow, Instruction, Mask, PC, SP, Stack};
use crate::narrow::{signed, target};

/// The instruction of the halfwords `high` and `low` at `address`.
pub fn decode(address: u32, high: u16, low: u16) -> Instruction {
    let (high, low) = (u32::from(high), u32::from(low));
    match (high >> 11 & 3, high >> 9 & 3) {
        (0b01, 0b00) if high & 0x40 == 0 => multiple(high, low),
        (0b01, 0b00) => dual(high, low),
        (0b01, 0b01) => shifted_register(high, low),
        (0b01 | 0b11, 0b10 | 0b11) => float::decode(high, low),
        (0b10, _) if low & 0x8000 != 0 => branch(address, high, low),
        (0b10, _) => immediate(high, low),
        (0b11, 0b00) => single(high, low),
        (0b11, 0b01) => registers(high, low),
        _ => Instruction::unknown(),
    }
}

/// Load and store multiple.
fn multiple(high: u32, low: u32) -> Instruction {
    let (base, load, writes_back) = (high & 0xF, high & 0x10 != 0, high & 0x20 != 0);
    let bytes = 4 * low.count_ones();
    let plain = Instruction::plain(4).accesses(low.count_ones());
    let on_stack = base == SP && writes_back;
    let stack = match (high >> 7 & 3, on_stack, load) {
        (0b00 | 0b11, ..) => return Instruction::unknown(),
        (_, false, _) => Stack::Keep,
        (0b10, true, false) => Stack::Push(bytes),
        (0b01, true, true) => Stack::Pop(bytes),
        _ => Stack::Unknown,
    };
    let stack = if low & 1 << SP != 0 {
        Stack::Unknown
    } else {
        stack
    };
    let flow = match (load && low & 1 << PC != 0, on_stack) {
        (false, _) => Flow::Next,
        (true, true) => Flow::Return,
        (true, false) => Flow::Computed,
    };
    plain.stack(stack).flow(flow)
}

/// Load and store dual and exclusive, table branch.
fn dual(high: u32, low: u32) -> Instruction {
    let plain = Instruction::plain(4);
    let (base, load, writes_back) = (high & 0xF, high & 0x10 != 0, high & 0x20 != 0);
    let (up, indexed) = (high & 0x80 != 0, high & 0x100 != 0);
    if high & 0xFFF0 == 0xE8D0 && low & 0xFFE0 == 0xF000 {
        let entry = 1 + (low >> 4 & 1);
        let base = (base != PC).then_some(base);
        return plain
            .accesses(1)
            .literals(true)
            .flow(Flow::Table { entry, base });
    }
    if !indexed && !writes_back {
        return plain.accesses(1);
    }
    let written = [low >> 12, low >> 8 & 0xF];
    if load && (written.contains(&SP) || written.contains(&PC)) {
        return Instruction::unknown();
    }
    let stack = writes_back.then(|| moved(base, up, 4 * (low & 0xFF)));
    plain
        .accesses(2)
        .literals(base == PC)
        .stack(stack.unwrap_or(Stack::Keep))
}

/// The base register moves by a constant.
fn moved(base: u32, up: bool, bytes: u32) -> Stack {
    match (base, up) {
        (SP, true) => Stack::Pop(bytes),
        (SP, false) => Stack::Push(bytes),
        _ => Stack::Keep,
    }
}

/// Data processing with a shifted register.
fn shifted_register(high: u32, low: u32) -> Instruction {
    let (operation, sets_flags) = (high >> 5 & 0xF, high & 0x10 != 0);
    let destination = low >> 8 & 0xF;
    let plain = Instruction::plain(4).sets_flags(sets_flags);
    match destination {
        PC if is_comparison(operation, sets_flags) => plain,
        PC => plain.flow(Flow::Computed),
        SP => plain.stack(Stack::Unknown),
        _ => plain,
    }
}

/// TST, TEQ, CMN and CMP are AND, EOR, ADD and SUB without a destination.
fn is_comparison(operation: u32, sets_flags: bool) -> bool {
    sets_flags && matches!(operation, 0b0000 | 0b0100 | 0b1000 | 0b1101)
}

/// Data processing with a constant.
fn immediate(high: u32, low: u32) -> Instruction {
    let (first, destination) = (high & 0xF, low >> 8 & 0xF);
    let twelve = (high >> 10 & 1) << 11 | (low >> 12 & 7) << 8 | low & 0xFF;
    let is_plain = high & 0x200 != 0;
    let (sum, sets_flags) = if is_plain {
        let sum = match high >> 4 & 0x1F {
            0b00000 => Some(twelve as i32),
            0b01010 => Some(-(twelve as i32)),
            _ => None,
        };
        (sum, false)
    } else {
        let sum = match high >> 5 & 0xF {
            0b1000 => Some(expanded(twelve) as i32),
            0b1101 => Some((expanded(twelve) as i32).wrapping_neg()),
            _ => None,
        };
        (sum, high & 0x10 != 0)
    };
    let plain = Instruction::plain(4).sets_flags(sets_flags);
    match (destination, first, sum) {
        (PC, ..) if is_comparison(high >> 5 & 0xF, sets_flags) => plain,
        (PC, ..) => plain.flow(Flow::Computed),
        (SP, SP, Some(sum)) => plain.stack(moved(SP, sum > 0, sum.unsigned_abs())),
        (SP, ..) => plain.stack(Stack::Unknown),
        _ => plain,
    }
}

/// The address that an instruction ADR at `place` computes, and the register that takes it.
pub(crate) fn address(place: u32, high: u16, low: u16) -> Option<(u32, u32)> {
    let (high, low) = (u32::from(high), u32::from(low));
    let offset = (high >> 10 & 1) << 11 | (low >> 12 & 7) << 8 | low & 0xFF;
    let base = (place + 4) & !3;
    let register = low >> 8 & 0xF;
    match (high & 0xFBFF, low & 0x8000) {
        (0xF20F, 0) => Some((base + offset, register)),
        (0xF2AF, 0) => Some((base.checked_sub(offset)?, register)),
        _ if high & 0xF800 == 0xA000 => Some((base + 4 * (high & 0xFF), high >> 8 & 7)),
        _ => None,
    }
}

/// A modified immediate constant, A5.3.2.
fn expanded(twelve: u32) -> u32 {
    let byte = twelve & 0xFF;
    match twelve >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | byte & 0x7F).rotate_right(twelve >> 7),
    }
}

/// Branches, calls and special registers.
fn branch(address: u32, high: u32, low: u32) -> Instruction {
    let plain = Instruction::plain(4);
    let (sign, j1, j2) = (high >> 10 & 1, low >> 13 & 1, low >> 11 & 1);
    // The bits J are stored as their difference from the sign.
    let (i1, i2) = (!(j1 ^ sign) & 1, !(j2 ^ sign) & 1);
    let long = sign << 24 | i1 << 23 | i2 << 22 | (high & 0x3FF) << 12 | (low & 0x7FF) << 1;
    let long = target(address, signed(long, 25));
    match low & 0xD000 {
        0xD000 => plain.flow(Flow::Call(long)),
        0x9000 => plain.flow(Flow::Jump(long)),
        0x8000 if high >> 7 & 7 != 7 => {
            let short = sign << 20 | j2 << 19 | j1 << 18 | (high & 0x3F) << 12 | (low & 0x7FF) << 1;
            plain.flow(Flow::Branch(target(address, signed(short, 21))))
        }
        0x8000 => special(high, low),
        _ => Instruction::unknown(),
    }
}

/// Special registers, barriers and hints.
fn special(high: u32, low: u32) -> Instruction {
    let plain = Instruction::plain(4).cycles(2);
    match high & 0xFFF0 {
        // MSR to the main and to the process stack pointer.
        0xF380 if low & 0xFF == 8 => plain.stack(Stack::Restart),
        0xF380 if low & 0xFF == 9 => plain.stack(Stack::Unknown),
        // PRIMASK, BASEPRI and FAULTMASK are restored; BASEPRI_MAX only raises BASEPRI.
        0xF380 if matches!(low & 0xFF, 0x10 | 0x11 | 0x13) => plain.mask(Mask::Restore),
        0xF380 if low & 0xFF == 0x12 => plain.mask(Mask::Raise),
        0xF380 => plain.sets_flags(low & 0xFF <= 3),
        0xF3A0 if matches!(low & 0xFF, 2 | 3) => plain.flow(Flow::Sleep),
        0xF3A0 => plain,
        // Barriers wait until the accesses before them have ended.
        0xF3B0 if low & 0xF0 == 0x60 => plain.cycles(FLUSH),
        0xF3B0 => plain.cycles(BARRIER),
        0xF3E0 => plain,
        0xF7F0 if low & 0xF000 == 0xA000 => plain.flow(Flow::Trap),
        _ => Instruction::unknown(),
    }
}

/// Cycles of ISB, which fetches what follows anew, as a taken branch: a line that was fetched ahead for
/// nothing, and its own.
const FLUSH: u32 = 1 + 3 + 10;

/// Cycles of a barrier, allowing for a write to a peripheral that is on its way.
const BARRIER: u32 = 20;

/// Load and store of one register.
fn single(high: u32, low: u32) -> Instruction {
    let (base, register) = (high & 0xF, low >> 12);
    let plain = Instruction::plain(4).accesses(1).literals(base == PC);
    let (load, size, sign) = (high & 0x10 != 0, high >> 5 & 3, high & 0x100 != 0);
    let has_offset_of_8_bits = high & 0x80 == 0 && low & 0x800 != 0 && base != PC;
    let writes_back = has_offset_of_8_bits && low & 0x100 != 0;
    if size == 3 {
        return Instruction::unknown();
    }
    let up = low & 0x200 != 0;
    let stack = if writes_back {
        moved(base, up, low & 0xFF)
    } else {
        Stack::Keep
    };
    if !load {
        return plain.stack(stack);
    }
    match (register, size) {
        // A return: the program counter from the top of the stack.
        (PC, 2) if !sign && base == SP && writes_back && up && low & 0x400 == 0 => {
            plain.stack(stack).flow(Flow::Return)
        }
        (PC, 2) => plain.flow(Flow::Computed),
        // A hint to load ahead.
        (PC, _) => plain,
        (SP, _) => plain.stack(Stack::Unknown),
        _ => plain.stack(stack),
    }
}

/// Data processing with registers, multiplication and division.
fn registers(high: u32, low: u32) -> Instruction {
    let plain = Instruction::plain(4);
    let destination = low >> 8 & 0xF;
    if destination == SP || destination == PC {
        return Instruction::unknown();
    }
    match high & 0xFFF0 {
        // SDIV, UDIV.
        0xFB90 | 0xFBB0 => plain.cycles(12),
        // MOV, with a shift by a register.
        0xFA10 | 0xFA30 | 0xFA50 | 0xFA70 => plain.sets_flags(true),
        _ => plain,
    }
}
