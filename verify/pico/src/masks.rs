//! `cpsid` and `cpsie`, whose two masks the emulated core confuses.

use rp2350_emu::core::CortexM33;

/// Executes the instruction at the program counter if it is one of these; else nothing.
pub(crate) fn step(core: &mut CortexM33, instruction: u16) -> bool {
    if instruction & 0xffec != 0xb660 {
        return false;
    }
    let masked = u32::from(instruction >> 4 & 1);
    if instruction & 2 != 0 {
        core.regs.primask = masked;
    }
    if instruction & 1 != 0 {
        core.regs.faultmask = masked;
    }
    let pc = core.regs.pc();
    core.regs.set_pc(pc + 2);
    true
}
