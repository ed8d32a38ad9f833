//! PIO0 makes the steps: state machines 0 and 1 the pulses of joints 1 and 4, 2 the ticks, and 3 the end of all pulses by the
//! emergency stop's pin.
//!
//! A tick of machine 2 begins a little before one of the core. Each time, machines 0 and 1 take the number that the core has
//! written since, and make its pulses; without a number they make none. So each number is made once and in one tick, and a program
//! that hangs makes no more steps.
//!
//! n pulses have periods of P = ⌊T/n⌋ clocks of the tick's T = 15,000. A pulse rises at (k + ½) P and is high for P/2 − 3 clocks, so
//! the last one ends before its tick does. What the last period leaves of the tick, 11 clocks (73 ns) or less for up to 20
//! pulses, is the only unevenness.
//!
//! Machine 3 waits for S1's pin. When that rises it makes both step pins inputs, whatever the others do, and they stay that
//! until [`StepMachines::power`] turns on again: the edge is 2 clocks in the synchroniser, 1 for its place between two clocks, and
//! 1 each for two instructions. No step rises 5 clocks after it, 34 ns; the resistors end one that is high.

use crate::board::rp2350::image::TICK_CYCLES;
use crate::board::rp2350::pins::{PULSES, STOP};
use crate::board::rp2350::resets;
use rp235x_pac::{PIO0, RESETS};

/// All programs; each has its first instruction.
const PROGRAM: [u16; 25] = [
    0xe020, // 0, steps: set x, 0        without a number: no pulses
    0x20d0, // 1: wait 1 irq 0 rel       the tick
    0x8080, // 2: pull noblock
    0x6046, // 3: out y, 6               their number
    0x0086, // 4: jmp y--, 6
    0x0000, // 5: jmp 0
    0xa0c7, // 6: mov isr, osr           both counts, for each period
    0x602d, // 7: out x, 13
    0x0048, // 8: jmp x--, 8             the first half period
    0xe001, // 9: set pins, 1
    0xa0e6, // 10: mov osr, isr
    0x602d, // 11: out x, 13
    0x004c, // 12: jmp x--, 12           high
    0xe000, // 13: set pins, 0
    0x0060, // 14: jmp !y, 0             that was the last one
    0x602d, // 15: out x, 13
    0x0050, // 16: jmp x--, 16           low
    0x0089, // 17: jmp y--, 9
    0xa022, // 18, ticks: mov x, y
    0x0053, // 19: jmp x--, 19
    0xc000, // 20: irq 0
    0xc001, // 21: irq 1, and again from 18
    WAIT_FOR_STOP,
    SET_INPUTS, // 23
    0x0018,     // 24: jmp 24
];
/// 22, the stop: `wait 1 gpio`
const WAIT_FOR_STOP: u16 = 0x2080 | STOP as u16;
/// `set pindirs` of both step pins: inputs, outputs.
const SET_INPUTS: u16 = 0xe080;
const SET_OUTPUTS: u16 = 0xe083;
/// Where the programs begin.
const TICKS: u8 = 18;
const TICKS_END: u8 = 21;
const WATCH: u8 = 22;
/// `jmp` to the program of the stop, and to what it does.
const GO_WATCH: u16 = WATCH as u16;
const GO_END: u16 = WATCH as u16 + 1;
/// `set pins, 0`, `pull block`, `mov y, osr`
const LOW: u16 = 0xe000;
const PULL: u16 = 0x80a0;
const TO_Y: u16 = 0xa047;
/// The machines of the ticks and of the stop; all four.
const TICKER: usize = 2;
const GUARD: usize = 3;
const ALL: u8 = 0b1111;
/// Clocks of a tick, of a period, of a tick's begin and of a pulse's end besides the counts.
const TICK_FIXED: u32 = 4;
const PERIOD_FIXED: u32 = 9;
const ENDS_FIXED: u32 = 14;

/// The state machines.
pub struct StepMachines {
    pio: PIO0,
    powered: bool,
}

impl StepMachines {
    /// Programs them: step pins not driven, and no ticks yet.
    pub fn new(pio: PIO0, resets: &RESETS) -> Self {
        resets::reset(resets, resets::PIO0);
        for (at, &instruction) in PROGRAM.iter().enumerate() {
            // SAFETY: any 16 bits are an instruction.
            #[allow(unsafe_code)]
            pio.instr_mem(at)
                .write(|w| unsafe { w.bits(u32::from(instruction)) });
        }
        let machines = Self {
            pio,
            powered: false,
        };
        let [first, _] = PULSES;
        for (machine, pin) in PULSES.into_iter().enumerate() {
            machines.set_up(machine, pin, 1, [0, PROGRAM.len() as u8 - 1]);
            machines.execute(machine, LOW);
        }
        machines.set_up(TICKER, first, 0, [TICKS, TICKS_END]);
        // SAFETY: any 32 bits are a number.
        #[allow(unsafe_code)]
        machines
            .pio
            .txf(TICKER)
            .write(|w| unsafe { w.bits(TICK_CYCLES - TICK_FIXED) });
        for instruction in [PULL, TO_Y, u16::from(TICKS)] {
            machines.execute(TICKER, instruction);
        }
        machines.set_up(
            GUARD,
            first,
            PULSES.len() as u8,
            [0, PROGRAM.len() as u8 - 1],
        );
        machines.execute(GUARD, GO_END);
        machines
    }

    /// The pins that a machine sets, and the instructions between which it goes round.
    fn set_up(&self, machine: usize, first_pin: usize, pins: u8, [bottom, top]: [u8; 2]) {
        let machine = self.pio.sm(machine);
        // SAFETY: the numbers of pins and instructions have 5 bits.
        #[allow(unsafe_code)]
        unsafe {
            machine
                .sm_pinctrl()
                .write(|w| w.set_base().bits(first_pin as u8).set_count().bits(pins));
            machine
                .sm_execctrl()
                .write(|w| w.wrap_bottom().bits(bottom).wrap_top().bits(top));
            machine.sm_clkdiv().write(|w| w.int().bits(1));
        }
    }

    /// Lets a machine execute an instruction now.
    #[inline]
    fn execute(&self, machine: usize, instruction: u16) {
        // SAFETY: any 16 bits are an instruction.
        #[allow(unsafe_code)]
        self.pio
            .sm(machine)
            .sm_instr()
            .write(|w| unsafe { w.bits(u32::from(instruction)) });
    }

    /// Lets the ticks begin. Called once.
    pub fn start() {
        // SAFETY: 4 bits; after its setup, nothing else writes this register.
        #[allow(unsafe_code)]
        unsafe {
            (*PIO0::ptr()).ctrl().write(|w| w.sm_enable().bits(ALL));
        }
    }

    /// Whether the machine of each joint has taken the number that was written last.
    #[inline]
    pub fn taken(&self) -> [bool; 2] {
        let empty = self.pio.fstat().read().txempty().bits();
        [empty & 1 != 0, empty & 2 != 0]
    }

    /// Hands a machine that has taken its last number this many pulses for the next tick.
    #[inline]
    pub fn prepare(&mut self, machine: usize, pulses: u32) {
        let number = TICK_CYCLES.checked_div(pulses).map_or(0, |period| {
            let high = (period - ENDS_FIXED) / 2;
            let low = period - high - PERIOD_FIXED;
            pulses | high << 6 | low << 19
        });
        // SAFETY: any 32 bits are a number.
        #[allow(unsafe_code)]
        self.pio.txf(machine).write(|w| unsafe { w.bits(number) });
    }

    /// Drives the step pins when `on` turns true, and not when it turns false.
    ///
    /// Pins that the emergency stop has made inputs stay that while `on` stays true.
    #[inline]
    pub fn power(&mut self, on: bool) {
        if on != self.powered {
            if on {
                // In this order: where the stop is pressed meanwhile, it is seen in the next clock.
                self.execute(GUARD, SET_OUTPUTS);
                self.execute(GUARD, GO_WATCH);
            } else {
                self.execute(GUARD, GO_END);
            }
            self.powered = on;
        }
    }

    /// Whether the emergency stop has ended the pulses.
    #[inline]
    pub fn is_stopped(&self) -> bool {
        self.powered && self.pio.sm(GUARD).sm_addr().read().bits() != u32::from(WATCH)
    }
}
