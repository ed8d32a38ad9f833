//! ADC1 to ADC3: injected sequences, started by TIM1, single or simultaneous.

use crate::register::Register;
use crate::time::{MICROSECOND, NEVER, Time};
use crate::violation::{Access, refuse};

/// Time from ADON to the first conversion.
const STABILISATION: Time = 3 * MICROSECOND;

/// Cycles of the converter from the trigger to the sequence, at most.
const LATENCY: u64 = 3;

/// One conversion's place in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleWindow {
    /// The converter, 0 for ADC1.
    pub converter: usize,
    /// Its input.
    pub channel: u8,
    /// When its sampling switch closes.
    pub from: Time,
    /// When it opens.
    pub until: Time,
}

/// One converter.
#[derive(Clone, Debug)]
struct Converter {
    sr: Register,
    cr1: Register,
    cr2: Register,
    smpr: [Register; 2],
    jofr: [Register; 4],
    jsqr: Register,
    jdr: [u32; 4],
    ready_at: Time,
    ends_at: Time,
}

/// The converters and their common part.
#[derive(Clone, Debug)]
pub(crate) struct Adc {
    converters: [Converter; 3],
    ccr: Register,
}

const JEOC: u32 = 2;
const JSTRT: u32 = 3;
const ADON: u32 = 0;

impl Converter {
    fn new() -> Self {
        Self {
            sr: Register::new("ADC_SR", 0, 0, 0x3f),
            cr1: Register::new("ADC_CR1", 0, 0x07c0_ffff, 0),
            cr2: Register::new("ADC_CR2", 0, 0x3f3f_0f03, 0x4040_0000),
            smpr: [
                Register::new("ADC_SMPR1", 0, 0x07ff_ffff, 0),
                Register::new("ADC_SMPR2", 0, 0x3fff_ffff, 0),
            ],
            jofr: [Register::new("ADC_JOFR", 0, 0xfff, 0); 4],
            jsqr: Register::new("ADC_JSQR", 0, 0x003f_ffff, 0),
            jdr: [0; 4],
            ready_at: NEVER,
            ends_at: NEVER,
        }
    }

    fn length(&self) -> usize {
        self.jsqr.field(20, 2) as usize + 1
    }

    /// The inputs of the injected sequence, in order.
    fn sequence(&self) -> Vec<u8> {
        let length = self.length();
        (4 - length..4)
            .map(|place| self.jsqr.field(5 * place as u32, 5) as u8)
            .collect()
    }

    fn sample_cycles(&self, channel: u8) -> u64 {
        let channel = u32::from(channel);
        let field = if channel >= 10 {
            self.smpr[0].field(3 * (channel - 10), 3)
        } else {
            self.smpr[1].field(3 * channel, 3)
        };
        [3, 15, 28, 56, 84, 112, 144, 480][field as usize]
    }
}

impl Adc {
    pub(crate) fn new() -> Self {
        Self {
            converters: [Converter::new(), Converter::new(), Converter::new()],
            ccr: Register::new("ADC_CCR", 0, 0x00c3_ef1f, 0),
        }
    }

    /// Period of the converters' clock.
    fn clock(&self, bus: Time) -> Time {
        bus * 2 * u64::from(1 + self.ccr.field(16, 2))
    }

    /// TIM1's trigger output rose: the windows of the sequences that it starts.
    pub(crate) fn trigger(&mut self, now: Time, bus: Time) -> Access<Vec<(usize, SampleWindow)>> {
        let mut windows = Vec::new();
        let dual = self.ccr.field(0, 5);
        let clock = self.clock(bus);
        for converter in 0..3 {
            let triggered = self.is_triggered(converter)
                || converter == 1 && matches!(dual, 1 | 5) && self.is_triggered(0);
            if triggered {
                self.start(converter, now, clock, &mut windows)?;
            }
        }
        Ok(windows)
    }

    fn is_triggered(&self, converter: usize) -> bool {
        let cr2 = &self.converters[converter].cr2;
        let edge = cr2.field(20, 2);
        cr2.bit(ADON) && cr2.field(16, 4) == 1 && matches!(edge, 1 | 3)
    }

    fn start(
        &mut self,
        number: usize,
        now: Time,
        clock: Time,
        windows: &mut Vec<(usize, SampleWindow)>,
    ) -> Access<()> {
        let dual = self.ccr.field(0, 5) == 5;
        let partner = self.converters[0].sequence();
        let converter = &mut self.converters[number];
        if !converter.cr2.bit(ADON) {
            return refuse("ADC_CR2", converter.cr2.value, "triggered while it is off");
        }
        if clock < 27_770_000 {
            return refuse(
                "ADC_CCR",
                self.ccr.value,
                "the converters' clock is above 36 MHz",
            );
        }
        if now < converter.ready_at {
            return refuse(
                "ADC_CR2",
                converter.cr2.value,
                "triggered before it is stable (3 µs)",
            );
        }
        if converter.ends_at != NEVER {
            return refuse(
                "ADC_JSQR",
                converter.jsqr.value,
                "triggered while the sequence runs",
            );
        }
        if converter.length() > 1 && !converter.cr1.bit(8) {
            return refuse(
                "ADC_CR1",
                converter.cr1.value,
                "a sequence of several inputs without SCAN",
            );
        }
        let sequence = converter.sequence();
        if dual && number == 1 && sequence.iter().zip(&partner).any(|(a, b)| a == b) {
            return refuse(
                "ADC_JSQR",
                converter.jsqr.value,
                "both converters sample one input at once",
            );
        }
        let bits = [12, 10, 8, 6][converter.cr1.field(24, 2) as usize];
        let mut at = now + LATENCY * clock;
        for (place, channel) in sequence.into_iter().enumerate() {
            let until = at + converter.sample_cycles(channel) * clock;
            windows.push((
                place,
                SampleWindow {
                    converter: number,
                    channel,
                    from: at,
                    until,
                },
            ));
            at = until + bits * clock;
        }
        converter.ends_at = at;
        converter.sr.set(JSTRT, true);
        Ok(())
    }

    /// Stores a sample as the program will read it.
    pub(crate) fn store(&mut self, place: usize, window: &SampleWindow, code: u16) {
        let converter = &mut self.converters[window.converter];
        let value = i32::from(code) - converter.jofr[place].value as i32;
        let resolution = 2 * converter.cr1.field(24, 2);
        let left = converter.cr2.bit(11);
        let value = (value >> resolution) as u32 & 0xffff;
        converter.jdr[place] = if left { value << 3 & 0xffff } else { value };
    }

    pub(crate) fn due(&self) -> Time {
        self.converters
            .iter()
            .map(|converter| converter.ends_at)
            .min()
            .unwrap_or(NEVER)
    }

    pub(crate) fn advance(&mut self, now: Time) {
        for converter in &mut self.converters {
            if converter.ends_at <= now {
                converter.ends_at = NEVER;
                converter.sr.set(JEOC, true);
            }
        }
    }

    pub(crate) fn interrupt(&self) -> bool {
        self.converters
            .iter()
            .any(|converter| converter.sr.bit(JEOC) && converter.cr1.bit(7))
    }

    pub(crate) fn read(&self, offset: u32) -> u32 {
        let Some(converter) = self.converters.get(offset as usize / 0x100) else {
            return match offset {
                0x300 => {
                    let status = |i: usize| self.converters[i].sr.value << (8 * i);
                    status(0) | status(1) | status(2)
                }
                0x304 => self.ccr.value,
                _ => 0,
            };
        };
        match offset % 0x100 {
            0x00 => converter.sr.value,
            0x04 => converter.cr1.value,
            0x08 => converter.cr2.value,
            0x0c => converter.smpr[0].value,
            0x10 => converter.smpr[1].value,
            place @ 0x14..=0x20 => converter.jofr[(place as usize - 0x14) / 4].value,
            0x38 => converter.jsqr.value,
            place @ 0x3c..=0x48 => converter.jdr[(place as usize - 0x3c) / 4],
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> Access<()> {
        let Some(converter) = self.converters.get_mut(offset as usize / 0x100) else {
            if offset != 0x304 {
                return refuse(
                    "ADC common",
                    value,
                    format!("no writable register at {offset:#x}"),
                );
            }
            if !matches!(value & 0x1f, 0 | 1 | 5) {
                return refuse(
                    "ADC_CCR",
                    value,
                    "this mode of several converters is not simulated",
                );
            }
            return self.ccr.write(value);
        };
        match offset % 0x100 {
            0x00 => {
                converter.sr.write(value)?;
                converter.sr.value &= value;
            }
            0x04 => converter.cr1.write(value)?,
            0x08 => {
                let was_on = converter.cr2.bit(ADON);
                converter.cr2.write(value)?;
                if value & 0x4040_0000 != 0 {
                    return refuse("ADC_CR2", value, "starts by software are not simulated");
                }
                if converter.cr2.bit(ADON) && !was_on {
                    converter.ready_at = now + STABILISATION;
                }
            }
            0x0c => converter.smpr[0].write(value)?,
            0x10 => converter.smpr[1].write(value)?,
            place @ 0x14..=0x20 => converter.jofr[(place as usize - 0x14) / 4].write(value)?,
            0x2c | 0x30 | 0x34 if value == 0 => {}
            0x38 => converter.jsqr.write(value)?,
            place => return refuse("ADC", value, format!("offset {place:#x} is not simulated")),
        }
        Ok(())
    }
}
