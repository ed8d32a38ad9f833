//! Both phase currents and the bus voltage, sampled in step with the PWM.
//!
//! TIM1's update event, in the middle of the braking phase at the bridges' inputs, starts ADC1 and
//! ADC2 together: PC0 (current 1) and PC1 (current 4) at once, then PC2 (bus) on ADC1. The end of
//! ADC1's sequence raises the interrupt that is the tick.
//!
//! The bridges' outputs follow their inputs 0.4 to 1.5 µs later, so the middle of their braking
//! phase, where the currents pass through their means, comes so much later, too. The currents are
//! therefore sampled for 1.3 µs and held 1.5 µs after the update. At the greatest duty, 0.95, the
//! outputs brake for 2.5 µs: the last edge is then 1.2 µs old or more (a slow bridge), eight time
//! constants of the amplifier; the next comes 0.2 µs later or more (a quick bridge). See
//! `docs/use/wiring.md`.

use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC2, RCC};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// Inputs of PC0, PC1 and PC2, the same on both converters.
const CURRENT1: u8 = 10;
const CURRENT4: u8 = 11;
const BUS: u8 = 12;
/// All of them.
pub const INPUTS: [u8; 3] = [CURRENT1, CURRENT4, BUS];
/// The converters' common mode: injected sequences of ADC1 and ADC2 start together.
const INJECTED_SIMULTANEOUS: u8 = 0b00101;

/// The converters.
pub struct CurrentsAndBus {
    adc1: ADC1,
    adc2: ADC2,
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
    /// Sets the sequences up; they run when TIM1 does.
    ///
    /// The converters' clock is 84 MHz / 4 = 21 MHz (36 at most). A sequence starts up to 3 cycles
    /// after its trigger. A conversion takes 28 cycles to sample a current, or 15 for the bus, and
    /// 12 to convert: 3.3 µs together.
    pub fn new((adc1, adc2): (ADC1, ADC2), common: &ADC_COMMON, rcc: &mut RCC) -> Self {
        ADC1::enable(rcc);
        ADC2::enable(rcc);
        // One reset for all converters.
        ADC1::reset(rcc);
        // SAFETY: the mode is one of the register's.
        #[allow(unsafe_code)]
        common.ccr().modify(|_, w| {
            unsafe { w.multi().bits(INJECTED_SIMULTANEOUS) }
                .adcpre()
                .div4()
        });
        adc1.smpr1()
            .modify(|_, w| w.smp10().cycles28().smp12().cycles15());
        adc2.smpr1().modify(|_, w| w.smp11().cycles28());
        // A sequence of n is the last n of the 4 places. SAFETY: channels are 0..=18.
        #[allow(unsafe_code)]
        unsafe {
            adc1.jsqr()
                .write(|w| w.jl().bits(1).jsq3().bits(CURRENT1).jsq4().bits(BUS));
            adc2.jsqr().write(|w| w.jl().bits(0).jsq4().bits(CURRENT4));
        }
        adc1.cr1()
            .modify(|_, w| w.scan().enabled().jeocie().enabled());
        // ADC1's trigger starts ADC2, which has none of its own.
        adc2.cr2().modify(|_, w| w.adon().enabled());
        adc1.cr2().modify(|_, w| {
            w.jextsel()
                .tim1trgo()
                .jexten()
                .rising_edge()
                .adon()
                .enabled()
        });
        Self { adc1, adc2 }
    }

    /// Takes the sequence just finished and its interrupt's flag.
    #[inline]
    pub fn take(&mut self) -> Samples {
        self.adc1
            .sr()
            .modify(|_, w| w.jeoc().clear_bit().jstrt().clear_bit());
        Samples {
            current: [
                self.adc1.jdr1().read().jdata().bits(),
                self.adc2.jdr1().read().jdata().bits(),
            ],
            bus_voltage: self.adc1.jdr2().read().jdata().bits(),
        }
    }
}
