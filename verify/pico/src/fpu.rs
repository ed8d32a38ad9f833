//! Instructions of the FPU that a Cortex-M33 has and the emulated core does not know: loads, stores and moves of registers in
//! pairs (`vldr d0`, `vpush {d8}`, `vmov r0, r1, d0`), `vsel`, `vminnm` and `vmaxnm`.

use crate::acquire;
use crate::bus::Bus;
use rp2350_emu::core::{CoreBus, CortexM33};

/// `vmov.f32 s0, s0` changes nothing, but saves a context of the FPU whose saving was put off.
const MOVE_NOTHING: [u16; 2] = [0xeeb0, 0x0a40];

/// Executes the instruction at the program counter if it is one of these; else nothing.
pub(crate) fn step(core: &mut CortexM33, bus: &mut Bus, [first, second]: [u16; 2]) -> bool {
    let of_pairs = first & 0xfe00 == 0xec00 && second >> 8 & 0xf == 0xb;
    let selects = first & 0xff80 == 0xfe00 && second & 0x0f50 == 0x0a00;
    let compares = first & 0xffb0 == 0xfe80 && second & 0x0f10 == 0x0a00;
    if !of_pairs && !selects && !compares {
        return false;
    }
    let conditional = core.it_state();
    let executes = conditional == 0 || core.regs.condition_passed(conditional >> 4);
    let pc = core.regs.pc();
    acquire::run(core, bus, MOVE_NOTHING);
    if executes && of_pairs {
        transfer(core, bus, pc, first, second);
    } else if executes {
        choose(core, first, second, selects);
    }
    core.regs.set_pc(pc + 4);
    true
}

/// `vsel`, `vminnm` and `vmaxnm`.
fn choose(core: &mut CortexM33, first: u16, second: u16, selects: bool) {
    let single = |high: u16, low: u16| usize::from((high & 0xf) << 1 | low & 1);
    let to = single(second >> 12, first >> 6);
    let values = [single(first, second >> 7), single(second, second >> 5)];
    let [one, other] = values.map(|single| core.regs.s[single]);
    let is_first = if selects {
        // Equal, overflow, at least, more.
        core.regs
            .condition_passed([0, 6, 10, 12][usize::from(first >> 4 & 3)])
    } else {
        let is_minimum = second & 0x40 != 0;
        let less = one < other || one == other && one.is_sign_negative();
        other.is_nan() || !one.is_nan() && less == is_minimum
    };
    core.regs.s[to] = if is_first { one } else { other };
}

fn transfer(core: &mut CortexM33, bus: &mut Bus, pc: u32, first: u16, second: u16) {
    let is_load = first & 0x10 != 0;
    let register = usize::from(first & 0xf);
    if first & 0xffe0 == 0xec40 {
        let single = 2 * usize::from(second & 0xf);
        for (core_register, single) in [(usize::from(second >> 12), single), (register, single + 1)]
        {
            if is_load {
                let value = core.regs.s[single].to_bits();
                core.set_reg(core_register, value);
            } else {
                core.regs.s[single] = f32::from_bits(core.reg(core_register));
            }
        }
        return;
    }
    let [before, up, write_back] = [8, 7, 5].map(|bit| first >> bit & 1 != 0);
    let bytes = 4 * u32::from(second & 0xff);
    let single = 2 * usize::from(second >> 12);
    let base = match register {
        15 => (pc + 4) & !3,
        13 => core.regs.sp(),
        other => core.reg(other),
    };
    let moved = if up {
        base.wrapping_add(bytes)
    } else {
        base.wrapping_sub(bytes)
    };
    let one = before && !write_back;
    let (start, count) = match (one, up) {
        (true, _) => (moved, 2),
        (false, true) => (base, bytes / 4),
        (false, false) => (moved, bytes / 4),
    };
    for (single, address) in (single..).zip((start..).step_by(4)).take(count as usize) {
        if is_load {
            core.regs.s[single] = f32::from_bits(bus.read32(address, 0));
        } else {
            bus.write32(address, core.regs.s[single].to_bits(), 0);
        }
    }
    if write_back {
        match register {
            13 => core.regs.set_sp(moved),
            other => core.set_reg(other, moved),
        }
    }
}
