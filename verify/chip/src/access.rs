//! The program's accesses to registers.

use crate::bus::{Unit, locate};
use crate::mcu::Mcu;
use crate::peripherals::adc::Adc;
use crate::peripherals::capture_timer::CaptureTimer;
use crate::peripherals::dma::Dma;
use crate::peripherals::encoder_timer::EncoderTimer;
use crate::peripherals::flash::Operation;
use crate::peripherals::pulse_timer::PulseTimer;
use crate::peripherals::pwm_timer::PwmTimer;
use crate::peripherals::tick_timer::TickTimer;
use crate::violation::{Access, refuse};
use fivebar_kinematics::five_bar::Joint;

/// Offset of a timer's counter.
const COUNTER: u32 = 0x24;

impl Mcu {
    /// The program reads a register.
    pub(crate) fn read(&mut self, address: u32, size: u32) -> Access<u32> {
        if let Some((word, bit)) = bit_band(address) {
            return Ok(self.read(word, 4)? >> bit & 1);
        }
        // The core's time is that of the end of its block: what came before happens first.
        self.run_events();
        let (unit, offset) = locate(self, address, None)?;
        let word = self.read_unit(unit, offset & !3)?;
        let value = word >> (8 * (offset & 3));
        if matches!(unit, Unit::Usart1) {
            self.settle(self.now);
        }
        Ok(if size == 4 {
            value
        } else {
            value & ((1 << (8 * size)) - 1)
        })
    }

    /// The program writes a register.
    pub(crate) fn write(&mut self, address: u32, size: u32, value: u32) -> Access<()> {
        if let Some((word, bit)) = bit_band(address) {
            let old = self.read(word, 4)?;
            return self.write(word, 4, old & !(1 << bit) | (value & 1) << bit);
        }
        self.run_events();
        let (unit, offset) = locate(self, address, Some(value))?;
        if unit != Unit::Scs && (offset & 3 != 0 || size == 1) {
            return refuse(
                &format!("{unit:?}+{offset:#x}"),
                value,
                "not the whole register is written",
            );
        }
        let result = self.write_unit(unit, offset, size, value);
        self.settle(self.now);
        result
    }

    fn read_unit(&mut self, unit: Unit, offset: u32) -> Access<u32> {
        let cycle = self.cycle_at(self.now);
        Ok(match unit {
            Unit::Rcc => self.rcc.read(offset),
            Unit::Flash => self.flash.read(offset),
            Unit::Tim1 => self.tim1.read(offset, self.now),
            Unit::Pulse if self.has_steppers() => self.tim8.read(offset, self.now),
            Unit::Pulse => self.pulse.read(offset),
            Unit::Ticks => self.ticks.read(offset, self.now),
            Unit::Encoder(Joint::Joint1) if self.is_on_bus() => self.ticks.read(offset, self.now),
            Unit::Can => self.can.read(offset)?,
            Unit::Encoder(joint) => {
                self.follow_encoder(joint, self.now);
                if offset == COUNTER {
                    self.counts_are_taken(self.now);
                }
                self.encoders[joint].read(offset)
            }
            Unit::Tool => self.tool.read(offset, self.now),
            Unit::Capture => {
                let clocks = self.capture_clocks();
                self.capture.read(offset, self.now, clocks)
            }
            Unit::Adc => self.adc.read(offset),
            Unit::Dma2 => self.dma.read(offset),
            Unit::Usart1 => self.usart.read(offset),
            Unit::Iwdg => self.iwdg.read(offset),
            Unit::Pwr => self.pwr.read(offset),
            Unit::Gpio(port) => {
                let levels = if offset == 0x10 { self.levels(port) } else { 0 };
                self.ports[usize::from(port)].read(offset, || levels)
            }
            Unit::Scs if (0x10..0x20).contains(&offset) => self.systick.read(offset, cycle)?,
            Unit::Scs => self.nvic.read(offset)?,
            Unit::Dwt => self
                .dwt
                .read(offset, cycle, self.nvic.demcr >> 24 & 1 != 0)?,
            Unit::Debug => self.debug.read(offset),
        })
    }

    fn write_unit(&mut self, unit: Unit, offset: u32, size: u32, value: u32) -> Access<()> {
        let cycle = self.cycle_at(self.now);
        match unit {
            Unit::Rcc => {
                self.rcc.write(offset, value, self.now)?;
                self.reset_units();
                self.follow_clocks(self.now);
                Ok(())
            }
            Unit::Flash => {
                let operation = self.flash.write(offset, value, self.now)?;
                self.follow_clocks(self.now);
                self.begin(operation);
                Ok(())
            }
            Unit::Tim1 => {
                let events = self.tim1.write(offset, value, self.now)?;
                if events.trigger {
                    self.trigger_converters(self.now);
                }
                Ok(())
            }
            Unit::Pulse if self.has_steppers() => {
                self.tim8.write(offset, value, self.now)?;
                Ok(())
            }
            Unit::Ticks => self.ticks.write(offset, value, self.now),
            Unit::Pulse => {
                let clock = self.pulse_clock();
                self.pulse.write(offset, value, self.now, clock)
            }
            Unit::Encoder(Joint::Joint1) if self.is_on_bus() => {
                self.ticks.write(offset, value, self.now)
            }
            Unit::Can => self.can.write(offset, value, self.now),
            Unit::Encoder(joint) => {
                self.follow_encoder(joint, self.now);
                self.encoders[joint].write(offset, value)
            }
            Unit::Tool => self.tool.write(offset, value, self.now),
            Unit::Capture => self.capture.write(offset, value, self.now),
            Unit::Adc => self.adc.write(offset, value, self.now),
            Unit::Dma2 => self.dma.write(offset, value),
            Unit::Usart1 => {
                self.usart.write(offset, value, self.now)?;
                self.usart.set_clock(self.bus_period(1));
                Ok(())
            }
            Unit::Iwdg => self.iwdg.write(offset, value, self.now),
            Unit::Pwr => self.pwr.write(offset, value),
            Unit::Gpio(port) => self.ports[usize::from(port)].write(offset, value),
            Unit::Scs if (0x10..0x20).contains(&offset) => self.systick.write(offset, value, cycle),
            Unit::Scs => self.nvic.write(offset, size, value),
            Unit::Dwt => {
                let trace = self.nvic.demcr >> 24 & 1 != 0;
                self.dwt.write(offset, value, cycle, trace)
            }
            Unit::Debug => self.debug.write(offset, value),
        }
    }

    /// Resets the units whose bits in RCC's reset registers are set.
    fn reset_units(&mut self) {
        let held = |bus: usize, bit: u32| self.rcc.in_reset(bus) >> bit & 1 != 0;
        let encoders = [held(3, 3), held(3, 0)];
        let (dma, adc, tim1, usart) = (held(0, 22), held(4, 8), held(4, 0), held(4, 4));
        for (encoder, held) in self.encoders.iter_mut().zip(encoders) {
            if held {
                *encoder = EncoderTimer::new();
            }
        }
        if self.rcc.in_reset(4) >> 1 & 1 != 0 {
            self.pulse = PulseTimer::new();
            self.tim8.reset();
        }
        let ticks = if self.is_on_bus() { 3 } else { 2 };
        if self.rcc.in_reset(3) >> 25 & 1 != 0 {
            self.can.reset();
        }
        if self.rcc.in_reset(3) >> ticks & 1 != 0 {
            self.ticks = TickTimer::new(self.core * self.rcc.timer_cycles(0));
        }
        if self.rcc.in_reset(4) >> 18 & 1 != 0 {
            self.capture = CaptureTimer::new();
        }
        if self.rcc.in_reset(3) >> 1 & 1 != 0 {
            self.tool = PwmTimer::new(self.core * self.rcc.timer_cycles(0));
        }
        if dma {
            self.dma = Dma::new();
        }
        if adc {
            self.adc = Adc::new();
        }
        if tim1 {
            self.tim1.reset();
        }
        if usart {
            self.usart.reset();
        }
    }

    /// The flash begins an operation: the core stands still until its end.
    pub(crate) fn begin(&mut self, operation: Operation) {
        match operation {
            Operation::None => {}
            Operation::Busy(until) => self.stalled_until = self.stalled_until.max(until),
            Operation::BusError => self.bus_error = true,
        }
    }
}

/// The word and bit behind an address of the bit-band alias.
fn bit_band(address: u32) -> Option<(u32, u32)> {
    let offset = address
        .checked_sub(0x4200_0000)
        .filter(|offset| *offset < 0x0200_0000)?;
    let byte = offset / 32;
    Some((0x4000_0000 + (byte & !3), 8 * (byte & 3) + offset / 4 % 8))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcu::Options;
    use crate::wiring::Unwired;

    const RCC_APB2ENR: u32 = 0x4002_3844;
    const TIM1: u32 = 0x4001_0000;
    const HALF_PERIOD: u32 = 100;

    /// A block may pass an end of the counter's way and then write to the timer: the end counts.
    #[test]
    fn a_write_just_after_an_end_of_the_counters_way_loses_no_repetition() {
        let mut mcu = Mcu::new(Options::default(), Vec::new(), Box::new(Unwired));
        let write = |mcu: &mut Mcu, address, value| mcu.write(address, 4, value).expect("legal");
        write(&mut mcu, RCC_APB2ENR, 1);
        // ARR, RCR, centre aligned, an update by software, then its flag cleared, then the start.
        for (offset, value) in [
            (0x2c, HALF_PERIOD),
            (0x30, 3),
            (0, 0x20),
            (0x14, 1),
            (0x10, 0),
            (0, 0x21),
        ] {
            write(&mut mcu, TIM1 + offset, value);
        }
        for ends in 1..=4 {
            mcu.now += u64::from(HALF_PERIOD) * mcu.core + u64::from(ends == 1);
            write(&mut mcu, TIM1 + 0x34, 7);
            let updated = mcu.read(TIM1 + 0x10, 4).expect("legal") & 1;
            assert_eq!(updated, u32::from(ends == 4), "after {ends} half periods");
        }
    }
}
