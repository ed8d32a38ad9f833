//! What a test does to the program: it hangs, loses its way, is late, or has no stack left.

use crate::chip::Chip;
use crate::report::Report;
use crate::time::{MICROSECOND, Time};
use crate::unicorn::Reg;

/// An address in RAM that the program does not use, and an endless loop for it: 32 instructions
/// that do nothing, and a branch to the first.
const UNUSED: u32 = 0x2001_f000;
const NOTHING: u32 = 0xbf00_bf00;
const BACK: u32 = 0xe7de;

impl Chip {
    /// The program stops: the core stands still with all interrupts masked, as in an endless
    /// loop, until a reset.
    pub fn hang(&mut self) {
        self.cpu_mut().locked_up = true;
    }

    /// The next exception finds only so many bytes of the stack left.
    pub fn leave_stack(&mut self, bytes: u32) {
        self.cpu_mut().stack_left = Some(bytes);
        self.cpu_mut().figures.stack_is_forced = true;
    }

    /// The program goes on at this address, as one does that has lost its way.
    pub fn go_on_at(&mut self, address: u32) {
        self.cpu_mut().engine.set(Reg::PC, address & !1);
    }

    /// An interrupt is disabled, as by a program that has lost its way.
    pub fn disable_interrupt(&mut self, interrupt: u32) {
        self.mcu().nvic.disable(interrupt);
    }

    /// An interrupt is raised that the program does not expect.
    pub fn raise_interrupt(&mut self, interrupt: u32) {
        self.mcu().nvic.raise(interrupt);
    }

    /// The core stands still for this long; everything else goes on.
    pub fn stall(&mut self, time: Time) {
        let mcu = self.mcu();
        mcu.stalled_until = mcu.stalled_until.max(mcu.now + time);
    }

    /// Whether the chip sends a byte on the serial line.
    pub fn is_sending(&mut self) -> bool {
        self.mcu().usart.is_sending()
    }

    /// The serial line takes so much longer for the byte that is being sent, as if more bytes
    /// followed it.
    pub fn prolong_sending(&mut self, time: Time) {
        let mcu = self.mcu();
        mcu.usart.prolong(time);
        mcu.due = mcu.next_due();
    }

    /// The program below the interrupts is late by this time: it stands still, and the interrupts
    /// go on.
    ///
    /// # Errors
    /// The first violation.
    pub fn hold_back(&mut self, time: Time) -> Result<(), Report> {
        let until = self.now() + time;
        self.run_below_the_interrupts()?;
        let place = self.cpu().engine.get(Reg::PC);
        (0..16).for_each(|word| self.write_ram_word(UNUSED + 4 * word, NOTHING));
        self.write_ram_word(UNUSED + 64, BACK);
        self.go_on_at(UNUSED);
        self.run_until(until)?;
        self.run_below_the_interrupts()?;
        self.go_on_at(place);
        Ok(())
    }

    /// Runs on into the interrupt of the next tick, to the end of its first block of code.
    ///
    /// # Errors
    /// The first violation.
    pub fn run_into_tick(&mut self) -> Result<(), Report> {
        self.run_below_the_interrupts()?;
        while self.cpu().mcu.nvic.active.last() != Some(&self.cpu().tick) {
            self.run(1)?;
        }
        Ok(())
    }

    /// Runs on until no exception is active and none is masked.
    ///
    /// # Errors
    /// The first violation.
    pub fn run_below_the_interrupts(&mut self) -> Result<(), Report> {
        loop {
            let cpu = self.cpu();
            let masks = cpu.engine.get(Reg::BASEPRI) | cpu.engine.get(Reg::PRIMASK);
            if masks == 0 && cpu.mcu.nvic.active.is_empty() {
                return Ok(());
            }
            self.run(MICROSECOND / 10)?;
        }
    }
}
