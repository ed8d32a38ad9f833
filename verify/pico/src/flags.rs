//! A state machine that waits for a flag. The emulated one takes the flag and waits on; here it then goes on to the next
//! instruction, in the same clock as the chip's.

use picoem_common::pio::PioBlock;

/// Registers of PIO: the flags, and where the first machine is and what it is told to execute. Those of the next one follow.
const FLAGS: u32 = 0x30;
const ADDRESS: u32 = 0xd4;
const EXECUTE: u32 = 0xd8;
const NEXT: u32 = 0x18;
/// `wait 1 irq`, without its flag.
const WAIT: u16 = 0x20c0;
const WAIT_BITS: u16 = 0xe0e0;
/// The flag's number is relative to that of the machine.
const RELATIVE: u16 = 0x10;

/// Lets all machines run for a clock, with these levels of the pins.
pub(crate) fn step(pio: &mut PioBlock, levels: u32) {
    let flags = pio.read32(FLAGS);
    if flags == 0 {
        return pio.step_with_pins(levels.into());
    }
    let before = [0, 1, 2, 3].map(|machine| pio.read32(ADDRESS + NEXT * machine));
    pio.step_with_pins(levels.into());
    for (machine, address) in (0..).zip(before) {
        let instruction = pio.instr_mem()[address as usize];
        if instruction & WAIT_BITS != WAIT {
            continue;
        }
        let number = u32::from(instruction & 7);
        let flag = if instruction & RELATIVE == 0 {
            number
        } else {
            number & 4 | (number + machine) & 3
        };
        let taken = flags >> flag & 1 != 0 && pio.read32(FLAGS) >> flag & 1 == 0;
        if taken && pio.read32(ADDRESS + NEXT * machine) == address {
            // `jmp` to the next one.
            pio.write32(EXECUTE + NEXT * machine, address + 1, 0);
        }
    }
}
