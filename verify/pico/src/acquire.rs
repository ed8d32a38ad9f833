//! Loads and stores with an order (`lda`, `stl`, `ldaex`, `stlex`), which a Cortex-M33 has and the emulated core does not know.
//! Its one core keeps every order, so each is done as the same load or store without one.

use crate::bus::Bus;
use rp2350_emu::core::CortexM33;

/// Instructions that the core does in place of others lie there in the ROM.
pub(crate) const PLACE: u32 = 0x200;

/// The load or store without an order that an instruction is; none of others.
fn without_order(first: u16, second: u16) -> Option<[u16; 2]> {
    let (base, value) = (first & 0xf, second & 0xf000);
    let (kind, status) = (second >> 4 & 0xf, second & 0xf);
    let load = match first & 0xfff0 {
        0xe8d0 => true,
        0xe8c0 => false,
        _ => return None,
    };
    if second & 0x0f00 != 0x0f00 {
        return None;
    }
    Some(match (kind, load) {
        (0x8, true) => [0xf890 | base, value],
        (0x9, true) => [0xf8b0 | base, value],
        (0xa, true) => [0xf8d0 | base, value],
        (0x8, false) => [0xf880 | base, value],
        (0x9, false) => [0xf8a0 | base, value],
        (0xa, false) => [0xf8c0 | base, value],
        (0xe, true) => [0xe850 | base, value | 0x0f00],
        (0xe, false) => [0xe840 | base, value | status << 8],
        // Of bytes and halves, one bit is the order.
        (0xc | 0xd, _) => [first, second & !0x80],
        _ => return None,
    })
}

/// Executes the instruction at the program counter if it is one of these; else nothing.
pub(crate) fn step(core: &mut CortexM33, bus: &mut Bus, [first, second]: [u16; 2]) -> bool {
    let Some(instruction) = without_order(first, second) else {
        return false;
    };
    let pc = core.regs.pc();
    run(core, bus, instruction);
    core.regs.set_pc(pc + 4);
    true
}

/// Lets the core execute this instruction, with no interrupt before it.
pub(crate) fn run(core: &mut CortexM33, bus: &mut Bus, instruction: [u16; 2]) {
    for (at, half) in (PLACE as usize..).step_by(2).zip(instruction) {
        bus.rom[at..at + 2].copy_from_slice(&half.to_le_bytes());
    }
    core.invalidate_decode_cache_entries(&[PLACE]);
    let mask = std::mem::replace(&mut core.regs.primask, 1);
    core.regs.set_pc(PLACE);
    core.step(bus);
    core.regs.primask = mask;
}
