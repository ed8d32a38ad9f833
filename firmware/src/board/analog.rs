//! Both phase currents and the bus voltage, sampled in step with the PWM.
//!
//! TIM1's update event, in the middle of the bridges' braking phase where the current
//! passes through its mean, starts ADC1's injected sequence: PC0 (current 1), PC1
//! (current 4), PC2 (bus). Its end raises the interrupt that is the tick.

use stm32f4xx_hal::gpio::{Analog, PC0, PC1, PC2};
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, RCC};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// ADC1 inputs of PC0, PC1 and PC2.
const CHANNELS: [u8; 3] = [10, 11, 12];

/// The converter.
pub struct CurrentsAndBus {
    adc: ADC1,
}

/// One sequence's results [ADC codes].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    /// Phase currents.
    pub current: [u16; 2],
    /// Bus voltage.
    pub bus_voltage: u16,
}

impl CurrentsAndBus {
    /// Sets the sequence up; it runs when TIM1 does.
    ///
    /// The ADC's clock is 84 MHz / 4 = 21 MHz (36 at most). A conversion takes 15 cycles
    /// to sample and 12 to convert, 1.3 µs; the sequence 3.9 µs.
    pub fn new(
        adc: ADC1,
        common: &ADC_COMMON,
        _pins: (PC0<Analog>, PC1<Analog>, PC2<Analog>),
        rcc: &mut RCC,
    ) -> Self {
        ADC1::enable(rcc);
        ADC1::reset(rcc);
        common.ccr().modify(|_, w| w.adcpre().div4());
        adc.smpr1()
            .modify(|_, w| w.smp10().cycles15().smp11().cycles15().smp12().cycles15());
        let [first, second, third] = CHANNELS;
        // A sequence of 3 is the last 3 of the 4 places. SAFETY: channels are 0..=18.
        #[allow(unsafe_code)]
        adc.jsqr().write(|w| unsafe {
            w.jl().bits(2);
            w.jsq2().bits(first).jsq3().bits(second).jsq4().bits(third)
        });
        adc.cr1()
            .modify(|_, w| w.scan().enabled().jeocie().enabled());
        adc.cr2().modify(|_, w| {
            w.jextsel()
                .tim1trgo()
                .jexten()
                .rising_edge()
                .adon()
                .enabled()
        });
        Self { adc }
    }

    /// Takes the sequence just finished and its interrupt's flag.
    #[inline]
    pub fn take(&mut self) -> Samples {
        self.adc
            .sr()
            .modify(|_, w| w.jeoc().clear_bit().jstrt().clear_bit());
        Samples {
            current: [
                self.adc.jdr1().read().jdata().bits(),
                self.adc.jdr2().read().jdata().bits(),
            ],
            bus_voltage: self.adc.jdr3().read().jdata().bits(),
        }
    }
}
