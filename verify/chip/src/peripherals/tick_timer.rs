//! TIM4, or TIM5 with drives on a bus, as the timer of the ticks: it counts up, and its update raises an interrupt and is its trigger output.

use crate::register::Register;
use crate::time::{NEVER, Time};
use crate::violation::{Access, refuse};

const CEN: u32 = 0;
const UIF: u32 = 0;
/// The master mode whose trigger output is the update.
const UPDATE: u32 = 2;

/// The timer.
#[derive(Clone, Debug)]
pub(crate) struct TickTimer {
    cr1: Register,
    cr2: Register,
    dier: Register,
    sr: Register,
    /// TIM4 has 16 bits of it.
    arr: Register,
    /// Period of the timer's clock.
    clock: Time,
    /// When the counter was at 0, while it runs.
    origin: Time,
    /// Since when a debugger's halt of the core stops it.
    halted_at: Option<Time>,
}

impl TickTimer {
    pub(crate) fn new(clock: Time) -> Self {
        Self {
            cr1: Register::new("TIMx_CR1", 0, 1, 0),
            cr2: Register::new("TIMx_CR2", 0, 0x70, 0),
            dier: Register::new("TIMx_DIER", 0, 1, 0),
            sr: Register::new("TIMx_SR", 0, 0, 0x1e5f),
            arr: Register::new("TIMx_ARR", !0, !0, 0),
            clock,
            origin: 0,
            halted_at: None,
        }
    }

    fn runs(&self) -> bool {
        self.cr1.bit(CEN)
    }

    fn period(&self) -> Time {
        self.clock * (u64::from(self.arr.value) + 1)
    }

    pub(crate) fn set_clock(&mut self, clock: Time, now: Time) {
        let counted = now.saturating_sub(self.origin) / self.clock;
        self.clock = clock;
        self.origin = now.saturating_sub(counted * clock);
    }

    pub(crate) fn due(&self) -> Time {
        match self.runs() && self.halted_at.is_none() {
            true => self.origin + self.period(),
            false => NEVER,
        }
    }

    /// The counter stops or goes on.
    pub(crate) fn halt(&mut self, halts: bool, now: Time) {
        let halted_at = std::mem::replace(&mut self.halted_at, halts.then_some(now));
        self.origin += halted_at.map_or(0, |at| now - at);
    }

    /// An update; true if it is a trigger.
    pub(crate) fn advance(&mut self) -> bool {
        self.origin += self.period();
        self.sr.set(UIF, true);
        self.cr2.field(4, 3) == UPDATE
    }

    /// When the tick began.
    pub(crate) fn began(&self) -> Time {
        self.origin
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.sr.bit(UIF) && self.dier.bit(0)
    }

    pub(crate) fn read(&self, offset: u32, now: Time) -> u32 {
        match offset {
            0x00 => self.cr1.value,
            0x04 => self.cr2.value,
            0x0c => self.dier.value,
            0x10 => self.sr.value,
            0x24 if self.runs() => {
                let at = self.halted_at.unwrap_or(now);
                (at.saturating_sub(self.origin) / self.clock) as u32
            }
            0x2c => self.arr.value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<()> {
        match offset {
            0x00 => {
                let ran = self.runs();
                self.cr1.write(value)?;
                if ran {
                    return refuse("TIMx_CR1", value, "only its start is simulated");
                }
                self.origin = now;
                Ok(())
            }
            0x04 => self.cr2.write(value),
            0x0c => self.dier.write(value),
            0x10 => {
                self.sr.write(value)?;
                self.sr.value &= value;
                Ok(())
            }
            0x2c if self.runs() => refuse("TIMx_ARR", value, "it changes while the counter runs"),
            0x2c => self.arr.write(value),
            _ => refuse(
                "TIMx",
                value,
                format!("offset {offset:#x} is not simulated"),
            ),
        }
    }
}
