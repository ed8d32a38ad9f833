//! Instructions of 16 bits. References are to the ARMv7-M Architecture Reference Manual, A5.2.

use crate::instruction::{Flow, Instruction, Mask, Stack};

const SP: u16 = 13;
const LR: u16 = 14;
const PC: u16 = 15;

/// `value`'s lowest `bits` bits as a signed number.
pub(crate) fn signed(value: u32, bits: u32) -> i32 {
    let shift = 32 - bits;
    ((value << shift) as i32) >> shift
}

/// The target of a branch at `address`, whose program counter is 4 bytes ahead.
pub(crate) fn target(address: u32, offset: i32) -> u32 {
    address.wrapping_add(4).wrapping_add_signed(offset)
}

/// The instruction `half` at `address`.
pub fn decode(address: u32, half: u16) -> Instruction {
    let plain = Instruction::plain(2);
    let word = u32::from(half);
    match half >> 12 {
        // Compare with a constant: 00101.
        0b0010 => plain.sets_flags(half & 0x0800 != 0),
        0b0100 => registers(half),
        0b0101..=0b1001 => plain.accesses(1),
        0b1011 => miscellaneous(address, half),
        // Load or store multiple.
        0b1100 => plain.accesses((word & 0xFF).count_ones()),
        0b1101 => match half >> 8 & 0xF {
            0xE => plain.flow(Flow::Trap),
            // A call of the supervisor is an exception of its own and comes back.
            0xF => plain,
            _ => plain.flow(Flow::Branch(target(address, signed(word << 1, 9)))),
        },
        0b1110 => plain.flow(Flow::Jump(target(address, signed(word << 1, 12)))),
        _ => plain,
    }
}

/// 0100…: data processing, special registers, branches to registers, loads of literals.
fn registers(half: u16) -> Instruction {
    let plain = Instruction::plain(2);
    let (destination, source) = ((half >> 4 & 8) | half & 7, half >> 3 & 0xF);
    match half >> 8 & 0xF {
        // TST, CMP, CMN.
        0x2 => plain.sets_flags(half & 0xC0 != 0x40),
        // ADD.
        0x4 if destination == PC => plain.flow(Flow::Computed),
        0x4 if destination == SP => plain.stack(Stack::Unknown),
        // CMP.
        0x5 => plain.sets_flags(true),
        // MOV.
        0x6 if destination == PC && source == LR => plain.flow(Flow::Return),
        0x6 if destination == PC => plain.flow(Flow::Jumps),
        0x6 if destination == SP => plain.stack(Stack::Unknown),
        // BX, BLX.
        0x7 if half & 0x80 != 0 => plain.flow(Flow::CallRegister),
        0x7 if source == LR => plain.flow(Flow::Return),
        0x7 => plain.flow(Flow::Computed),
        0x8..=0xF => plain.accesses(1).literals(true),
        _ => plain,
    }
}

/// 1011…: the stack, compare and branch, if-then, hints.
fn miscellaneous(address: u32, half: u16) -> Instruction {
    let plain = Instruction::plain(2);
    let word = u32::from(half);
    let immediate = (word & 0x7F) * 4;
    let registers = (word & 0x1FF).count_ones();
    match half >> 8 & 0xF {
        0x0 if half & 0x80 == 0 => plain.stack(Stack::Pop(immediate)),
        0x0 => plain.stack(Stack::Push(immediate)),
        // CBZ, CBNZ.
        0x1 | 0x3 | 0x9 | 0xB => {
            let offset = (word >> 9 & 1) << 6 | (word >> 3 & 0x1F) << 1;
            plain.flow(Flow::Branch(target(address, offset as i32)))
        }
        0x4 | 0x5 => plain.accesses(registers).stack(Stack::Push(4 * registers)),
        0xC => plain.accesses(registers).stack(Stack::Pop(4 * registers)),
        0xD => plain
            .accesses(registers)
            .stack(Stack::Pop(4 * registers))
            .flow(Flow::Return),
        // Interrupts masked or not: CPS.
        0x6 if half & 0x10 != 0 => plain.cycles(2).mask(Mask::Raise),
        0x6 => plain.cycles(2).mask(Mask::Open),
        0xF if half & 0xF != 0 => plain.flow(if_then(half)),
        // Wait for an event, wait for an interrupt.
        0xF if matches!(half >> 4 & 0xF, 2 | 3) => plain.flow(Flow::Sleep),
        _ => plain,
    }
}

/// The condition's last bit and the mask give the sense of each instruction behind the first.
fn if_then(half: u16) -> Flow {
    let (condition, mask) = (half >> 4 & 0xF, half & 0xF);
    let slots = 4 - mask.trailing_zeros() as u8;
    let same = if condition & 1 == 1 { mask } else { !mask };
    let senses = (1..slots).fold(1, |senses, slot| {
        senses | ((same >> (4 - slot) & 1) as u8) << slot
    });
    Flow::IfThen {
        slots,
        senses,
        condition: condition as u8,
    }
}
