//! TIM8 as a generator of one pulse for each update of TIM1: it counts up once from its trigger on, and its
//! channel 1, in PWM mode 2, is its trigger output.

use crate::register::Register;
use crate::time::{NEVER, Time};
use crate::violation::{Access, refuse};

const CEN: u32 = 0;
const OPM: u32 = 3;
/// The slave mode in which a trigger starts the counter.
const STARTS: u32 = 6;
/// The master mode whose trigger output is channel 1's reference.
const OC1REF: u32 = 4;
const PWM_MODE_2: u32 = 7;

/// The timer.
#[derive(Clone, Debug)]
pub(crate) struct PulseTimer {
    cr1: Register,
    cr2: Register,
    smcr: Register,
    ccmr1: Register,
    arr: Register,
    ccr1: Register,
    /// When the pulse that runs begins and ends.
    edge: Time,
    end: Time,
    /// Since when a debugger's halt of the core stops it.
    halted_at: Option<Time>,
}

impl PulseTimer {
    pub(crate) fn new() -> Self {
        Self {
            cr1: Register::new("TIM8_CR1", 0, 0x9, 0),
            cr2: Register::new("TIM8_CR2", 0, 0x70, 0),
            smcr: Register::new("TIM8_SMCR", 0, 0x77, 0),
            ccmr1: Register::new("TIM8_CCMR1", 0, 0x70, 0),
            arr: Register::new("TIM8_ARR", 0xffff, 0xffff, 0),
            ccr1: Register::new("TIM8_CCR1", 0, 0xffff, 0),
            edge: NEVER,
            end: NEVER,
            halted_at: None,
        }
    }

    /// TIM1 triggers; `clock` is the timer's period.
    pub(crate) fn trigger(&mut self, at: Time, clock: Time) {
        // TIM1 is its trigger 0. A trigger within a pulse does nothing.
        if self.smcr.value == STARTS && !self.cr1.bit(CEN) {
            self.start(at, clock);
        }
    }

    fn start(&mut self, at: Time, clock: Time) {
        self.cr1.set(CEN, true);
        self.end = at + clock * (u64::from(self.arr.value) + 1);
        let has_output = self.cr2.field(4, 3) == OC1REF && self.ccmr1.field(4, 3) == PWM_MODE_2;
        let rises = has_output && self.ccr1.value <= self.arr.value;
        self.edge = if rises {
            at + clock * u64::from(self.ccr1.value)
        } else {
            NEVER
        };
    }

    pub(crate) fn due(&self) -> Time {
        match self.halted_at {
            None => self.edge.min(self.end),
            Some(_) => NEVER,
        }
    }

    /// The counter stops or goes on.
    pub(crate) fn halt(&mut self, halts: bool, now: Time) {
        let halted_at = std::mem::replace(&mut self.halted_at, halts.then_some(now));
        let passed = halted_at.map_or(0, |at| now - at);
        for at in [&mut self.edge, &mut self.end] {
            if *at != NEVER {
                *at += passed;
            }
        }
    }

    /// Lets the pulse go on; true if it begins.
    pub(crate) fn advance(&mut self, now: Time) -> bool {
        if self.end <= now {
            self.cr1.set(CEN, false);
            self.end = NEVER;
        }
        let begins = self.edge <= now;
        if begins {
            self.edge = NEVER;
        }
        begins
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        match offset {
            0x00 => self.cr1.value,
            0x04 => self.cr2.value,
            0x08 => self.smcr.value,
            0x18 => self.ccmr1.value,
            0x2c => self.arr.value,
            0x34 => self.ccr1.value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time, clock: Time) -> Access<()> {
        match offset {
            0x00 => {
                let ran = self.cr1.bit(CEN);
                self.cr1.write(value)?;
                if ran && !self.cr1.bit(CEN) {
                    return refuse("TIM8_CR1", value, "a stop within a pulse is not simulated");
                }
                if self.cr1.bit(CEN) && !self.cr1.bit(OPM) {
                    return refuse("TIM8_CR1", value, "only single pulses are simulated");
                }
                if !ran && self.cr1.bit(CEN) {
                    self.start(now, clock);
                }
            }
            0x04 => self.cr2.write(value)?,
            0x08 => {
                if !matches!(value & 7, 0 | STARTS) {
                    return refuse("TIM8_SMCR", value, "this slave mode is not simulated");
                }
                if self.smcr.field(0, 3) != 0 && (value ^ self.smcr.value) & 0x70 != 0 {
                    return refuse("TIM8_SMCR", value, "the trigger changes while it is in use");
                }
                if value & 7 == STARTS && !self.cr1.bit(OPM) {
                    return refuse("TIM8_SMCR", value, "only single pulses are simulated");
                }
                self.smcr.write(value)?;
            }
            0x18 => self.ccmr1.write(value)?,
            0x2c => self.arr.write(value)?,
            0x34 => self.ccr1.write(value)?,
            _ => {
                let rule = format!("offset {offset:#x} is not simulated");
                return refuse("TIM8", value, rule);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::PulseTimer;
    use crate::time::NEVER;

    /// At a clock of 10: pulses from 1 to 84.
    fn timer() -> PulseTimer {
        let mut timer = PulseTimer::new();
        for (offset, value) in [
            (0x2c, 84),
            (0x34, 1),
            (0x18, 0x70),
            (0x04, 0x40),
            (0, 8),
            (8, 6),
        ] {
            timer.write(offset, value, 0, 10).expect("legal");
        }
        timer
    }

    #[test]
    fn each_trigger_makes_one_pulse() {
        let mut timer = timer();
        for at in [1000, 5000] {
            timer.trigger(at, 10);
            assert_eq!(timer.due(), at + 10);
            assert!(timer.advance(at + 10));
            assert!(timer.read(0) & 1 != 0, "it counts");
            timer.trigger(at + 20, 10);
            assert_eq!(timer.due(), at + 850);
            assert!(!timer.advance(at + 850));
            assert_eq!((timer.due(), timer.read(0) & 1), (NEVER, 0));
        }
    }

    #[test]
    fn the_program_starts_a_pulse_too() {
        let mut timer = timer();
        timer.write(0, 9, 300, 10).expect("legal");
        assert!(timer.advance(310));
    }

    #[test]
    fn what_is_not_simulated_is_refused() {
        let mut timer = timer();
        for (offset, value) in [
            (0, 1),
            (0, 0x19),
            (4, 0x80),
            (8, 7),
            (8, 0x16),
            (0x20, 1),
            (0x24, 1),
        ] {
            assert!(
                timer.write(offset, value, 0, 10).is_err(),
                "{offset:#x}: {value:#x}"
            );
        }
    }
}
