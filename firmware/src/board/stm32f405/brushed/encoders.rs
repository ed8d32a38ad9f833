//! Both quadrature encoders, on the 32-bit timers TIM5 (joint 1) and TIM2 (joint 4).
//!
//! **The latch.** The timers latch their counts themselves, both at the same instant, at the update of TIM1 that
//! starts the tick: no interrupt and no critical section shifts it. TIM1 triggers TIM8, whose pulse
//! triggers channel 3 of TIM5 and TIM2, which capture their counters. TIM1 reaches TIM2 itself but not TIM5, and
//! the pulse of its update may be too short for timers of half its clock: TIM8 has TIM1's clock, and its own
//! pulse lasts 0.5 µs. From the update to the latch it takes 0.1 µs at most.
//!
//! **The filters.** Each input has a digital filter, because a motor's lead beside the encoder's cable couples
//! pulses into it. A level counts after six equal samples at an eighth of the timers' 84 MHz, so
//! a pulse shorter than 0.57 µs counts nothing. A true level must then last seven samples,
//! 0.67 µs. At c counts/s a level lasts 2/c, or 1/c if the encoder's edges are unevenly spaced,
//! so the filter follows up to 1 500 000 counts/s: settings that allow more are refused. The
//! benchtop arm needs 1 100 000 at the speed that is a fault (52.5 rad/s, 131 072 counts a turn).
//! Both inputs are delayed alike.

use stm32f4xx_hal::pac::{RCC, TIM2, TIM5, TIM8, tim2, tim5};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// TIM8's pulse in its 168 MHz: 0.5 µs, 42 clocks of the timers that see it.
const PULSE: u16 = 84;
/// TIM8 among the triggers of TIM5.
const TIM8_OF_TIM5: u8 = 3;

/// Lets a timer of 32 bits count each edge of both inputs. The types of the two timers' registers differ.
macro_rules! quadrature {
    ($timer:ident) => {
        $timer.ccmr1_input().write(|w| w.cc1s().ti1().cc2s().ti2());
        $timer.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit());
        $timer.smcr().write(|w| w.sms().encoder_mode_3());
        $timer.arr().write(|w| w.arr().set(u32::MAX));
        $timer.cr1().write(|w| w.cen().enabled());
    };
}

/// The counters.
pub struct Encoders(());

impl Encoders {
    /// Counts both joints; `latch` triggers both.
    pub fn new(joint1: &TIM5, joint4: &TIM2, latch: &TIM8, rcc: &mut RCC) -> Self {
        TIM5::enable(rcc);
        TIM5::reset(rcc);
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        quadrature!(joint1);
        quadrature!(joint4);
        let (timer1, timer4) = timers();
        timer1
            .ccmr1_input()
            .modify(|_, w| w.ic1f().fdts_div8_n6().ic2f().fdts_div8_n6());
        timer4
            .ccmr1_input()
            .modify(|_, w| w.ic1f().fdts_div8_n6().ic2f().fdts_div8_n6());
        // SAFETY: the number of a trigger.
        #[allow(unsafe_code)]
        timer1
            .smcr()
            .modify(|_, w| unsafe { w.ts().bits(TIM8_OF_TIM5) });
        timer4.smcr().modify(|_, w| w.ts().itr1());
        timer1.ccmr2_input().modify(|_, w| w.cc3s().trc());
        timer4.ccmr2_input().modify(|_, w| w.cc3s().trc());
        timer1.ccer().modify(|_, w| w.cc3e().set_bit());
        timer4.ccer().modify(|_, w| w.cc3e().set_bit());
        set_up_latch(latch, rcc);
        Self(())
    }

    /// Both counts, which wrap, as they were latched. The next latch comes a tick later.
    #[inline]
    pub fn latched(&self) -> [i32; 2] {
        let (timer1, timer4) = timers();
        let counts = [timer1.ccr(2).read().bits(), timer4.ccr(2).read().bits()];
        counts.map(u32::cast_signed)
    }
}

/// Latches the counts by software: where TIM1 does not run, which starts the ticks otherwise.
pub fn latch() {
    // SAFETY: TIM1 does not run, so nothing else starts the pulse.
    #[allow(unsafe_code)]
    unsafe {
        (*TIM8::ptr()).cr1().modify(|_, w| w.cen().enabled());
    }
}

/// One pulse from each trigger of TIM1 on: TIM8 counts from its trigger to `PULSE` once, and its channel 1 is
/// high from 1 on.
fn set_up_latch(timer: &TIM8, rcc: &mut RCC) {
    TIM8::enable(rcc);
    TIM8::reset(rcc);
    timer.arr().write(|w| w.arr().set(PULSE));
    timer.ccr(0).write(|w| w.ccr().set(1));
    timer.ccmr1_output().write(|w| w.oc1m().pwm_mode2());
    timer.cr2().write(|w| w.mms().compare_oc1());
    timer.cr1().write(|w| w.opm().enabled());
    timer.smcr().write(|w| w.ts().itr0().sms().trigger_mode());
}

fn timers() -> (&'static tim5::RegisterBlock, &'static tim2::RegisterBlock) {
    // SAFETY: nothing but this module accesses both timers.
    #[allow(unsafe_code)]
    unsafe {
        (&*TIM5::ptr(), &*TIM2::ptr())
    }
}
