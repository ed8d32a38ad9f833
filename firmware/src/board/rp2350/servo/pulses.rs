//! The pulses of both servos: state machines 0 and 1 of PIO0.
//!
//! A state machine waits for a number, makes one pulse of it, and waits again. So a program that hangs or ends makes no more
//! pulses, and a servo without pulses gives no torque: no watchdog is needed for that.
//!
//! | | instruction | |
//! |---|---|---|
//! | 0 | `pull block` | waits for the number |
//! | 1 | `mov x, osr` | |
//! | 2 | `jmp pin, 0` | the emergency stop is pressed: no pulse |
//! | 3 | `set pins, 1` | |
//! | 4 | `jmp pin, 6` | it is pressed now: the pulse ends |
//! | 5 | `jmp x--, 4` | |
//! | 6 | `set pins, 0` | |
//!
//! A pulse is high for 2 x + 3 clocks of 150 MHz: x + 1 rounds of instructions 4 and 5, and instruction 6. Each change of the
//! stop's pin waits 2 clocks in the synchroniser, 1 at most for instruction 4, and 1 each for instructions 4 and 6; with 1 for its
//! place between two clocks the pulse is over 6 clocks after the press, 40 ns. A pulse that begins does so in less.

use crate::board::rp2350::pins::{PULSES, STOP};
use crate::board::rp2350::resets;
use rp235x_pac::{PIO0, RESETS};

const PROGRAM: [u16; 7] = [0x80a0, 0xa027, 0x00c0, 0xe001, 0x00c6, 0x0044, 0xe000];
/// `set pindirs, 1`
const OUTPUT: u16 = 0xe081;
/// Both state machines.
const BOTH: u8 = 0b11;
/// Clocks of a pulse besides two for each count.
const FIXED_CLOCKS: u32 = 3;

/// Both state machines.
pub struct Pulses {
    pio: PIO0,
}

impl Pulses {
    /// Both pins low; the state machines wait.
    pub fn new(pio: PIO0, resets: &RESETS) -> Self {
        resets::reset(resets, resets::PIO0);
        for (at, &instruction) in PROGRAM.iter().enumerate() {
            // SAFETY: any 16 bits are an instruction.
            #[allow(unsafe_code)]
            pio.instr_mem(at)
                .write(|w| unsafe { w.bits(u32::from(instruction)) });
        }
        for (machine, pin) in PULSES.into_iter().enumerate() {
            let machine = pio.sm(machine);
            // SAFETY: the numbers of pins and instructions have 5 bits, and the instructions are ones.
            #[allow(unsafe_code)]
            unsafe {
                machine
                    .sm_pinctrl()
                    .write(|w| w.set_base().bits(pin as u8).set_count().bits(1));
                machine.sm_execctrl().write(|w| {
                    w.jmp_pin().bits(STOP as u8);
                    w.wrap_bottom()
                        .bits(0)
                        .wrap_top()
                        .bits(PROGRAM.len() as u8 - 1)
                });
                machine.sm_clkdiv().write(|w| w.int().bits(1));
                let low = PROGRAM[PROGRAM.len() - 1];
                machine.sm_instr().write(|w| w.bits(u32::from(low)));
                machine.sm_instr().write(|w| w.bits(u32::from(OUTPUT)));
            }
        }
        // SAFETY: 4 bits.
        #[allow(unsafe_code)]
        pio.ctrl().write(|w| unsafe { w.sm_enable().bits(BOTH) });
        Self { pio }
    }

    /// Makes one pulse of so many clocks of joint 1 (0) or 4 (1), unless it still makes one: it never waits.
    #[inline]
    pub fn make(&mut self, machine: usize, clocks: u32) {
        let count = clocks.saturating_sub(FIXED_CLOCKS) / 2;
        if self.pio.fstat().read().txempty().bits() & 1 << machine != 0 {
            // SAFETY: any 32 bits are a number.
            #[allow(unsafe_code)]
            self.pio.txf(machine).write(|w| unsafe { w.bits(count) });
        }
    }
}
