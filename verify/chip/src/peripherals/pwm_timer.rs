//! TIM3, a 16-bit timer, as a generator of pulses: it counts up, and its channels are in PWM
//! mode 1.

use crate::register::Register;
use crate::time::{NEVER, Time};
use crate::violation::{Access, refuse};

const CEN: u32 = 0;
const ARPE: u32 = 7;

/// What a channel does to its pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pulses {
    /// Not driven by the timer.
    Released,
    /// At one level all the time.
    Level(bool),
    /// High at the beginning of each frame.
    Frames {
        /// For so long.
        high: Time,
        /// Length of a frame.
        frame: Time,
    },
}

/// The values that the counter works with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Loaded {
    divider: u32,
    top: u32,
    compare: [u32; 4],
}

/// The timer.
#[derive(Clone, Debug)]
pub(crate) struct PwmTimer {
    cr1: Register,
    sr: Register,
    ccmr: [Register; 2],
    ccer: Register,
    psc: Register,
    arr: Register,
    ccr: [Register; 4],
    loaded: Loaded,
    /// Period of the timer's clock.
    clock: Time,
    /// When the counter was at 0, while it runs.
    origin: Time,
    /// The count, while it stands still.
    count: u32,
}

impl PwmTimer {
    pub(crate) fn new(clock: Time) -> Self {
        let compare = Register::new("TIM3_CCR", 0, 0xffff, 0);
        Self {
            cr1: Register::new("TIM3_CR1", 0, 0x81, 0),
            sr: Register::new("TIM3_SR", 0, 0, 0x1e5f),
            // OCxM and OCxPE of both channels, all of them outputs.
            ccmr: [Register::new("TIM3_CCMR", 0, 0x7878, 0); 2],
            ccer: Register::new("TIM3_CCER", 0, 0x3333, 0),
            psc: Register::new("TIM3_PSC", 0, 0xffff, 0),
            arr: Register::new("TIM3_ARR", 0xffff, 0xffff, 0),
            ccr: [compare; 4],
            loaded: Loaded {
                divider: 1,
                top: 0xffff,
                compare: [0; 4],
            },
            clock,
            origin: 0,
            count: 0,
        }
    }

    fn runs(&self) -> bool {
        self.cr1.bit(CEN)
    }

    /// Time of one count.
    fn tick(&self) -> Time {
        self.clock * u64::from(self.loaded.divider)
    }

    fn frame(&self) -> Time {
        self.tick() * (u64::from(self.loaded.top) + 1)
    }

    fn count_at(&self, now: Time) -> u32 {
        if !self.runs() {
            return self.count;
        }
        (now.saturating_sub(self.origin) % self.frame() / self.tick()) as u32
    }

    pub(crate) fn set_clock(&mut self, clock: Time, now: Time) {
        let count = self.count_at(now);
        self.clock = clock;
        self.origin = now.saturating_sub(u64::from(count) * self.tick());
    }

    /// What an update would load.
    fn preloaded(&self) -> Loaded {
        Loaded {
            divider: self.psc.value + 1,
            top: self.arr.value,
            compare: self.ccr.map(|ccr| ccr.value),
        }
    }

    /// Takes what is not preloaded.
    fn follow(&mut self) {
        if !self.cr1.bit(ARPE) {
            self.loaded.top = self.arr.value;
        }
        for channel in 0..4 {
            let preload = 3 + 8 * (channel as u32 % 2);
            if !self.ccmr[channel / 2].bit(preload) {
                self.loaded.compare[channel] = self.ccr[channel].value;
            }
        }
    }

    /// The next update that loads something.
    pub(crate) fn due(&self) -> Time {
        if self.runs() && self.preloaded() != self.loaded {
            self.next_update()
        } else {
            NEVER
        }
    }

    fn next_update(&self) -> Time {
        // The counter may have passed the top since its origin; the last frame counts.
        self.origin + self.frame()
    }

    /// Lets frames end.
    pub(crate) fn advance(&mut self, now: Time) {
        if self.runs() && now >= self.next_update() {
            let frames = (now - self.origin) / self.frame();
            self.origin += frames * self.frame();
            self.loaded = self.preloaded();
        }
    }

    /// What channel 1 to 4 (0 to 3) does.
    pub(crate) fn pulses(&self, channel: usize) -> Pulses {
        let enable = 4 * channel as u32;
        if !self.ccer.bit(enable) {
            return Pulses::Released;
        }
        let inverted = self.ccer.bit(enable + 1);
        let mode = self.ccmr[channel / 2].field(4 + 8 * (channel as u32 % 2), 3);
        let (high, top) = (self.loaded.compare[channel], self.loaded.top);
        let level = match mode {
            6 if high == 0 => false,
            6 if high > top => true,
            6 if !self.runs() => self.count < high,
            6 => {
                let high = if inverted { top + 1 - high } else { high };
                return Pulses::Frames {
                    high: self.tick() * u64::from(high),
                    frame: self.frame(),
                };
            }
            // Frozen.
            _ => false,
        };
        Pulses::Level(level ^ inverted)
    }

    pub(crate) fn read(&self, offset: u32, now: Time) -> u32 {
        match offset {
            0x00 => self.cr1.value,
            0x10 => self.sr.value,
            0x18 => self.ccmr[0].value,
            0x1c => self.ccmr[1].value,
            0x20 => self.ccer.value,
            0x24 => self.count_at(now),
            0x28 => self.psc.value,
            0x2c => self.arr.value,
            0x34..=0x40 => self.ccr[(offset as usize - 0x34) / 4].value,
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<()> {
        self.advance(now);
        match offset {
            0x00 => {
                let count = self.count_at(now);
                self.cr1.write(value)?;
                self.count = count;
                self.origin = now.saturating_sub(u64::from(count) * self.tick());
            }
            0x10 => self.sr.write(value)?,
            0x14 => {
                if value != 1 {
                    return refuse("TIM3_EGR", value, "only UG is simulated");
                }
                self.loaded = self.preloaded();
                self.origin = now;
                self.count = 0;
            }
            0x18 | 0x1c => self.set_mode((offset as usize - 0x18) / 4, value)?,
            0x20 => self.ccer.write(value)?,
            0x28 => self.psc.write(value)?,
            0x2c => {
                if value == 0 {
                    return refuse("TIM3_ARR", value, "the counter is blocked at 0");
                }
                self.arr.write(value)?;
            }
            0x34..=0x40 => self.ccr[(offset as usize - 0x34) / 4].write(value)?,
            _ => {
                let rule = format!("offset {offset:#x} is not simulated");
                return refuse("TIM3", value, rule);
            }
        }
        self.follow();
        Ok(())
    }

    fn set_mode(&mut self, index: usize, value: u32) -> Access<()> {
        for (mode, channel) in [
            (value >> 4 & 7, 2 * index),
            (value >> 12 & 7, 2 * index + 1),
        ] {
            let enabled = self.ccer.bit(4 * channel as u32);
            if !matches!(mode, 0 | 6) {
                return refuse("TIM3_CCMR", value, "this mode is not simulated");
            }
            if enabled && mode == 0 {
                return refuse("TIM3_CCMR", value, "an enabled channel is frozen");
            }
        }
        self.ccmr[index].write(value)
    }
}

#[cfg(test)]
mod tests {
    use super::{Pulses, PwmTimer};
    use crate::time::MICROSECOND;

    /// At a clock of 1 MHz: frames of 20 ms, pulses of 1 ms, preloaded.
    fn servo() -> PwmTimer {
        let mut timer = PwmTimer::new(MICROSECOND);
        for (offset, value) in [
            (0x2c, 19_999),
            (0x18, 0x6800),
            (0x38, 1000),
            (0x20, 0x10),
            (0x14, 1),
            (0, 1),
        ] {
            timer.write(offset, value, 0).expect("legal");
        }
        timer
    }

    fn frames(high: u64, frame: u64) -> Pulses {
        Pulses::Frames {
            high: high * MICROSECOND,
            frame: frame * MICROSECOND,
        }
    }

    #[test]
    fn a_preloaded_value_acts_from_the_next_frame_on() {
        let mut timer = servo();
        assert_eq!(timer.pulses(1), frames(1000, 20_000));
        timer
            .write(0x38, 1500, 50_500 * MICROSECOND)
            .expect("legal");
        assert_eq!(timer.pulses(1), frames(1000, 20_000));
        assert_eq!(timer.due(), 60_000 * MICROSECOND);
        timer.advance(60_000 * MICROSECOND);
        assert_eq!(timer.pulses(1), frames(1500, 20_000));
    }

    #[test]
    fn without_preload_a_value_acts_at_once() {
        let mut timer = servo();
        timer.write(0x18, 0x6000, 0).expect("legal");
        for (value, pulses) in [
            (1500, frames(1500, 20_000)),
            (0, Pulses::Level(false)),
            (20_000, Pulses::Level(true)),
        ] {
            timer.write(0x38, value, MICROSECOND).expect("legal");
            assert_eq!(timer.pulses(1), pulses);
        }
    }

    #[test]
    fn a_slower_clock_makes_longer_pulses_and_a_divider_waits_for_its_update() {
        let mut timer = servo();
        timer.set_clock(3 * MICROSECOND, 5 * MICROSECOND);
        assert_eq!(timer.pulses(1), frames(3000, 60_000));
        timer.write(0x28, 1, 6 * MICROSECOND).expect("legal");
        assert_eq!(timer.pulses(1), frames(3000, 60_000));
        timer.write(0x14, 1, 7 * MICROSECOND).expect("legal");
        assert_eq!(timer.pulses(1), frames(6000, 120_000));
    }

    #[test]
    fn what_is_not_simulated_is_refused() {
        let mut timer = servo();
        for (offset, value) in [
            (0x00, 0x11),
            (0x04, 0x20),
            (0x08, 1),
            (0x0c, 1),
            (0x14, 2),
            (0x18, 0x7000),
            (0x18, 0),
            (0x18, 0x6801),
            (0x24, 5),
            (0x2c, 0),
            (0x38, 0x1_0000),
        ] {
            let refused = timer.write(offset, value, 0);
            assert!(refused.is_err(), "{offset:#x}: {value:#x}");
        }
    }
}
