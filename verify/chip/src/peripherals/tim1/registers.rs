//! What the program reads from and writes to TIM1's registers.

use super::{BIF, FLAGS, MOE, RESET_MODE, Tim1, Tim1Events};
use crate::time::Time;
use crate::violation::{Access, refuse};

impl Tim1 {
    pub(crate) fn read(&self, offset: u32, now: Time) -> u32 {
        let (count, down) = self.counter(now);
        match offset {
            0x00 => {
                let direction = if self.is_centred() {
                    down
                } else {
                    self.cr1.bit(4)
                };
                self.cr1.value & !0x10 | u32::from(direction) << 4
            }
            0x04 => self.cr2.value,
            0x08 => self.smcr.value,
            0x0c => self.dier.value,
            0x10 => self.sr.value,
            0x18 => self.ccmr[0].value,
            0x1c => self.ccmr[1].value,
            0x20 => self.ccer.value,
            0x24 => count,
            0x28 => self.psc.value,
            0x2c => self.arr.value,
            0x30 => self.rcr.value,
            0x34..=0x40 => self.ccr[(offset as usize - 0x34) / 4].value,
            0x44 => self.bdtr.value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<Tim1Events> {
        self.rebase(now);
        let mut events = Tim1Events::default();
        match offset {
            0x00 => self.write_cr1(value)?,
            0x04 => self.write_cr2(value)?,
            0x08 => self.write_smcr(value)?,
            0x0c => self.dier.write(value)?,
            0x10 => {
                self.sr.write(value)?;
                self.sr.value &= value | !FLAGS;
                if self.is_broken() {
                    self.sr.set(BIF, true);
                }
            }
            0x14 => events.trigger = self.generate(value)?,
            0x18 | 0x1c => self.write_ccmr((offset as usize - 0x18) / 4, value)?,
            0x20 => self.ccer.write(value)?,
            0x24 => {
                if self.is_centred() && self.runs() {
                    return refuse(
                        "TIM1_CNT",
                        value,
                        "the counter is written while it counts up and down",
                    );
                }
                self.phase = (value & 0xffff).into();
            }
            0x28 => self.psc.write(value)?,
            0x2c => {
                self.arr.write(value)?;
                if !self.cr1.bit(7) {
                    self.top = self.arr.value;
                }
            }
            0x30 => {
                self.rcr.write(value)?;
                self.repetitions_written_running = self.runs();
            }
            0x34..=0x40 => self.write_ccr((offset as usize - 0x34) / 4, value)?,
            0x44 => self.write_bdtr(value)?,
            _ => {
                return refuse(
                    "TIM1",
                    value,
                    format!("offset {offset:#x} is not simulated"),
                );
            }
        }
        self.plan();
        Ok(events)
    }

    fn write_cr1(&mut self, value: u32) -> Access<()> {
        let mode_changes = (value ^ self.cr1.value) & 0x60 != 0;
        if mode_changes && (self.runs() || value & 1 != 0) {
            return refuse(
                "TIM1_CR1",
                value,
                "the alignment changes while the counter is enabled",
            );
        }
        self.cr1.write(value)
    }

    fn write_cr2(&mut self, value: u32) -> Access<()> {
        if self.bdtr.field(8, 2) >= 1 && (value ^ self.cr2.value) & 0x7f00 != 0 {
            return refuse("TIM1_CR2", value, "the idle states are locked");
        }
        if !matches!(value >> 4 & 7, 0..=2) {
            return refuse("TIM1_CR2", value, "this trigger output is not simulated");
        }
        self.cr2.write(value)
    }

    fn write_smcr(&mut self, value: u32) -> Access<()> {
        let trigger = value >> 4 & 7;
        if !matches!(value & 7, 0 | RESET_MODE) || value & !0x77 != 0 {
            return refuse("TIM1_SMCR", value, "this slave mode is not simulated");
        }
        if value & 7 == RESET_MODE && (trigger != self.trigger || self.is_centred()) {
            return refuse(
                "TIM1_SMCR",
                value,
                "it is started anew by TIM4 only, counting up",
            );
        }
        if self.is_restarted() && trigger != self.smcr.field(4, 3) {
            return refuse("TIM1_SMCR", value, "the trigger changes while it is in use");
        }
        self.smcr.write(value)
    }

    fn write_ccmr(&mut self, which: usize, value: u32) -> Access<()> {
        if value & 0x0303 != 0 {
            return refuse(self.ccmr[which].name, value, "captures are not simulated");
        }
        self.ccmr[which].write(value)
    }

    fn write_ccr(&mut self, channel: usize, value: u32) -> Access<()> {
        self.ccr[channel].write(value)?;
        let preloaded = self.ccmr[channel / 2].bit(3 + 8 * (channel as u32 % 2));
        if !preloaded {
            self.compare[channel] = value;
        }
        Ok(())
    }

    fn write_bdtr(&mut self, value: u32) -> Access<()> {
        let level = self.bdtr.field(8, 2);
        if level >= 1 && (value ^ self.bdtr.value) & 0x70ff != 0 {
            return refuse("TIM1_BDTR", value, "the break's set-up is locked");
        }
        let lock = if self.bdtr_locked {
            level << 8
        } else {
            value & 0x300
        };
        self.bdtr_locked |= value & 0x300 != 0;
        self.bdtr.write(value & !0x300 | lock)?;
        if self.is_broken() {
            self.bdtr.set(MOE, false);
        }
        Ok(())
    }

    /// EGR: true if the trigger output rises.
    fn generate(&mut self, value: u32) -> Access<bool> {
        if value & !0xff != 0 {
            return refuse("TIM1_EGR", value, "reserved bits");
        }
        if value & 0x80 != 0 {
            self.bdtr.set(MOE, false);
            self.sr.set(BIF, true);
        }
        if value & 1 == 0 {
            return Ok(false);
        }
        self.phase = 0;
        let trigger = self.update(true);
        Ok(trigger || self.cr2.field(4, 3) == 0)
    }
}
