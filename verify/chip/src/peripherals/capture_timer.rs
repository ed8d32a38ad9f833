//! TIM11, a 16-bit timer: it captures its counter at edges of the crystal's divided clock.

use crate::register::Register;
use crate::time::Time;
use crate::violation::{Access, refuse};

const CC1IF: u32 = 1;
const CC1OF: u32 = 9;

/// The timer.
#[derive(Clone, Debug)]
pub(crate) struct CaptureTimer {
    cr1: Register,
    sr: Register,
    ccmr1: Register,
    ccer: Register,
    option: Register,
    /// When it began to count, and its count then.
    since: Time,
    /// Captures so far, of which the program has read so many.
    captures: u64,
    read: u64,
}

/// What the timer works with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clocks {
    /// Period of its own clock.
    pub(crate) timer: Time,
    /// Period of the crystal's divided clock; none if the crystal does not run.
    pub(crate) crystal: Option<Time>,
}

impl CaptureTimer {
    pub(crate) fn new() -> Self {
        Self {
            cr1: Register::new("TIM11_CR1", 0, 0x387, 0),
            sr: Register::new("TIM11_SR", 0, 0, 0x203),
            ccmr1: Register::new("TIM11_CCMR1", 0, 0xff, 0),
            ccer: Register::new("TIM11_CCER", 0, 0xb, 0),
            option: Register::new("TIM11_OR", 0, 3, 0),
            since: 0,
            captures: 0,
            read: 0,
        }
    }

    /// Time from one capture to the next; none if there are none.
    fn interval(&self, clocks: Clocks) -> Option<Time> {
        let captures = self.cr1.bit(0)
            && self.ccer.bit(0)
            && self.ccmr1.field(0, 2) == 1
            && self.option.value == 2;
        clocks
            .crystal
            .filter(|_| captures)
            .map(|period| period << self.ccmr1.field(2, 2))
    }

    /// Takes the captures up to now.
    fn follow(&mut self, now: Time, clocks: Clocks) {
        let Some(interval) = self.interval(clocks) else {
            return;
        };
        self.captures = (now - self.since) / interval;
        self.sr.set(CC1IF, self.captures > self.read);
        if self.captures > self.read + 1 {
            self.sr.set(CC1OF, true);
        }
    }

    pub(crate) fn read(&mut self, offset: u32, now: Time, clocks: Clocks) -> u32 {
        self.follow(now, clocks);
        match offset {
            0x00 => self.cr1.value,
            0x10 => self.sr.value,
            0x18 => self.ccmr1.value,
            0x20 => self.ccer.value,
            0x34 => {
                self.read = self.captures;
                self.sr.set(CC1IF, false);
                let at = self.captures * self.interval(clocks).unwrap_or(0);
                (at / clocks.timer) as u32 & 0xffff
            }
            0x50 => self.option.value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<()> {
        match offset {
            0x00 => {
                self.cr1.write(value)?;
                self.since = now;
            }
            0x18 => self.ccmr1.write(value)?,
            0x20 => self.ccer.write(value)?,
            0x50 => self.option.write(value)?,
            _ => {
                return refuse(
                    "TIM11",
                    value,
                    format!("offset {offset:#x} is not simulated"),
                );
            }
        }
        Ok(())
    }
}
