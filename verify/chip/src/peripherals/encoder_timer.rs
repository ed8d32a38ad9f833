//! TIM2 and TIM5, the 32-bit timers, in encoder mode.

use crate::register::Register;
use crate::violation::{Access, refuse};

const CC3IF: u32 = 3;
const CC3OF: u32 = 11;
const CC3E: u32 = 8;
/// A channel's input is the timer's trigger.
const TRC: u32 = 3;

/// One timer. Its inputs come as the counts of the encoder wired to it.
#[derive(Clone, Debug)]
pub(crate) struct EncoderTimer {
    cr1: Register,
    smcr: Register,
    dier: Register,
    sr: Register,
    ccmr1: Register,
    ccmr2: Register,
    ccer: Register,
    psc: Register,
    arr: Register,
    count: u32,
    /// What channel 3 has captured.
    ccr3: u32,
    /// The encoder's counts when `count` was right.
    origin: i32,
}

impl EncoderTimer {
    pub(crate) fn new() -> Self {
        Self {
            cr1: Register::new("TIMx_CR1", 0, 0x3ff, 0),
            smcr: Register::new("TIMx_SMCR", 0, 0xfff7, 0),
            dier: Register::new("TIMx_DIER", 0, 0x5f5f, 0),
            sr: Register::new("TIMx_SR", 0, 0, 0x1e5f),
            ccmr1: Register::new("TIMx_CCMR1", 0, 0xffff, 0),
            ccmr2: Register::new("TIMx_CCMR2", 0, 0xffff, 0),
            ccer: Register::new("TIMx_CCER", 0, 0xbbbb, 0),
            psc: Register::new("TIMx_PSC", 0, 0xffff, 0),
            arr: Register::new("TIMx_ARR", !0, !0, 0),
            count: 0,
            ccr3: 0,
            origin: 0,
        }
    }

    /// Takes the encoder's counts; `connected` are the inputs that reach the timer.
    pub(crate) fn follow(&mut self, counts: i32, connected: bool) {
        let moved = counts.wrapping_sub(self.origin);
        self.origin = counts;
        if !self.cr1.bit(0) || !connected || self.ccmr1.value & 0x303 == 0 {
            return;
        }
        // One input inverted, or the inputs exchanged, turns the direction round.
        let inverted = self.ccer.bit(1) ^ self.ccer.bit(5);
        let exchanged = self.ccmr1.field(0, 2) == 2 && self.ccmr1.field(8, 2) == 2;
        let moved = if inverted ^ exchanged {
            moved.wrapping_neg()
        } else {
            moved
        };
        // Both edges of both inputs, or of one of them only.
        let counted = match self.smcr.field(0, 3) {
            3 => moved,
            1 | 2 => moved / 2,
            _ => 0,
        };
        let modulus = u64::from(self.arr.value) + 1;
        let count = i64::from(self.count) + i64::from(counted);
        self.count = count.rem_euclid(modulus as i64) as u32;
    }

    /// Another timer triggers, the one of this number: true if channel 3 captures the counter.
    pub(crate) fn trigger(&mut self, number: u32) -> bool {
        let captures =
            self.ccer.bit(CC3E) && self.ccmr2.field(0, 2) == TRC && self.smcr.field(4, 3) == number;
        if captures {
            self.ccr3 = self.count;
            self.sr.set(CC3OF, self.sr.bit(CC3IF));
            self.sr.set(CC3IF, true);
        }
        captures
    }

    /// Samples that both inputs must agree on before a level counts, in clocks of the timer.
    pub(crate) fn filter_clocks(&self) -> u32 {
        let division = 1 << self.cr1.field(8, 2).min(2);
        let filter = self.ccmr1.field(4, 4).min(self.ccmr1.field(12, 4));
        let (divider, samples) = match filter {
            0 => return 0,
            1 => return 2,
            2 => return 4,
            3 => return 8,
            4 => (2, 6),
            5 => (2, 8),
            6 => (4, 6),
            7 => (4, 8),
            8 => (8, 6),
            9 => (8, 8),
            10 => (16, 5),
            11 => (16, 6),
            12 => (16, 8),
            13 => (32, 5),
            14 => (32, 6),
            _ => (32, 8),
        };
        division * divider * samples
    }

    pub(crate) fn read(&mut self, offset: u32) -> u32 {
        match offset {
            0x00 => self.cr1.value,
            0x08 => self.smcr.value,
            0x0c => self.dier.value,
            0x10 => self.sr.value,
            0x18 => self.ccmr1.value,
            0x1c => self.ccmr2.value,
            0x20 => self.ccer.value,
            0x3c => {
                self.sr.set(CC3IF, false);
                self.ccr3
            }
            0x24 => self.count,
            0x28 => self.psc.value,
            0x2c => self.arr.value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 => self.cr1.write(value)?,
            0x08 => {
                if value & 7 > 3 {
                    return refuse("TIMx_SMCR", value, "this slave mode is not simulated");
                }
                if self.cr1.bit(0) && (value ^ self.smcr.value) & 7 != 0 {
                    return refuse(
                        "TIMx_SMCR",
                        value,
                        "the mode changes while the counter runs",
                    );
                }
                if self.ccer.bit(CC3E) && (value ^ self.smcr.value) & 0x70 != 0 {
                    return refuse("TIMx_SMCR", value, "the trigger changes while it is in use");
                }
                self.smcr.write(value)?;
            }
            0x0c => self.dier.write(value)?,
            0x10 => self.sr.write(value)?,
            0x14 if value & 1 != 0 => self.count = 0,
            0x14 => {}
            0x18 => {
                if self.ccer.value & 0x11 != 0 && (value ^ self.ccmr1.value) & 0x303 != 0 {
                    return refuse(
                        "TIMx_CCMR1",
                        value,
                        "CCxS changes while the channel is enabled",
                    );
                }
                self.ccmr1.write(value)?;
            }
            0x1c => {
                if self.ccer.bit(CC3E) {
                    return refuse("TIMx_CCMR2", value, "channel 3 is enabled");
                }
                if !matches!(value, 0 | TRC) {
                    return refuse(
                        "TIMx_CCMR2",
                        value,
                        "only a capture by a trigger is simulated",
                    );
                }
                self.ccmr2.write(value)?;
            }
            0x20 => {
                if value & 0xba00 != 0 {
                    return refuse(
                        "TIMx_CCER",
                        value,
                        "only the rising edge of channel 3 is simulated",
                    );
                }
                self.ccer.write(value)?;
            }
            0x24 => self.count = value,
            0x28 => self.psc.write(value)?,
            0x2c => self.arr.write(value)?,
            _ => {
                return refuse(
                    "TIMx",
                    value,
                    format!("offset {offset:#x} is not simulated"),
                );
            }
        }
        Ok(())
    }
}
