//! The independent watchdog.

use crate::register::Register;
use crate::time::{NEVER, Time, period};
use crate::violation::{Access, refuse};

/// Slow cycles until a new prescaler or reload value has arrived.
const UPDATE: u64 = 5;
/// A value that arrives when the slow oscillator runs.
const WAITING: Time = NEVER - 1;

/// The watchdog.
#[derive(Clone, Debug)]
pub(crate) struct Iwdg {
    pr: Register,
    rlr: Register,
    unlocked: bool,
    running: bool,
    works: bool,
    /// Period of the slow oscillator.
    slow: Time,
    /// The values in effect, and when the written ones arrive.
    prescaler: u32,
    reload: u32,
    prescaler_at: Time,
    reload_at: Time,
    /// When the counter reaches zero.
    bites_at: Time,
    /// Since when a debugger's halt of the core stops it.
    halted_at: Option<Time>,
}

impl Iwdg {
    /// `lsi` is the frequency of the slow oscillator: 32 kHz, 17 to 47 kHz [Hz]. One that does not work
    /// never bites.
    pub(crate) fn new(lsi: f64, works: bool) -> Self {
        Self {
            pr: Register::new("IWDG_PR", 0, 7, 0),
            rlr: Register::new("IWDG_RLR", 0xfff, 0xfff, 0),
            unlocked: false,
            running: false,
            works,
            slow: period(lsi),
            prescaler: 0,
            reload: 0xfff,
            prescaler_at: NEVER,
            reload_at: NEVER,
            bites_at: NEVER,
            halted_at: None,
        }
    }

    fn step(&self) -> Time {
        self.slow * (4 << self.prescaler.min(6))
    }

    fn restart(&mut self, now: Time) {
        if self.running && self.works {
            self.bites_at = now + self.step() * u64::from(self.reload + 1);
        }
    }

    pub(crate) fn runs(&self) -> bool {
        self.running
    }

    /// Starts the slow oscillator and the counter, which begins at its reset value.
    fn start(&mut self, now: Time) {
        if self.running {
            return;
        }
        self.running = true;
        if self.works {
            self.bites_at = now + self.step() * 0x1000;
        }
        for at in [&mut self.prescaler_at, &mut self.reload_at] {
            if *at == WAITING {
                *at = now + UPDATE * self.slow;
            }
        }
    }

    pub(crate) fn due(&self) -> Time {
        let bites_at = match self.halted_at {
            None => self.bites_at,
            Some(_) => NEVER,
        };
        self.prescaler_at.min(self.reload_at).min(bites_at)
    }

    /// The counter stops or goes on.
    pub(crate) fn halt(&mut self, halts: bool, now: Time) {
        let halted_at = std::mem::replace(&mut self.halted_at, halts.then_some(now));
        if self.bites_at != NEVER {
            self.bites_at += halted_at.map_or(0, |at| now - at);
        }
    }

    /// Lets written values arrive; true if the watchdog resets the chip.
    pub(crate) fn advance(&mut self, now: Time) -> bool {
        if self.prescaler_at <= now {
            self.prescaler_at = NEVER;
            let left = self.bites_at.saturating_sub(now) / self.step();
            self.prescaler = self.pr.value;
            if self.running && self.works {
                self.bites_at = now + left * self.step();
            }
        }
        if self.reload_at <= now {
            self.reload_at = NEVER;
            self.reload = self.rlr.value;
        }
        self.halted_at.is_none() && self.bites_at <= now
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0x4 => self.pr.value,
            0x8 => self.rlr.value,
            0xc => u32::from(self.prescaler_at != NEVER) | u32::from(self.reload_at != NEVER) << 1,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<()> {
        match offset {
            0x0 => {
                self.unlocked = value == 0x5555;
                match value {
                    0x5555 => {}
                    0xaaaa => self.restart(now),
                    0xcccc => self.start(now),
                    _ => return refuse("IWDG_KR", value, "not a key"),
                }
            }
            0x4 | 0x8 => {
                let (register, at, other) = if offset == 0x4 {
                    (&mut self.pr, &mut self.prescaler_at, "IWDG_PR")
                } else {
                    (&mut self.rlr, &mut self.reload_at, "IWDG_RLR")
                };
                if !self.unlocked {
                    return refuse(other, value, "the register is locked");
                }
                if *at != NEVER {
                    return refuse(other, value, "the value before has not arrived yet");
                }
                register.write(value)?;
                // Before the start the slow oscillator does not run.
                *at = if self.running {
                    now + UPDATE * self.slow
                } else {
                    WAITING
                };
            }
            _ => {
                return refuse(
                    "IWDG",
                    value,
                    format!("no writable register at {offset:#x}"),
                );
            }
        }
        Ok(())
    }
}
