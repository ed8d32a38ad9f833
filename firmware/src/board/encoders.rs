//! Both quadrature encoders, on the 32-bit timers TIM5 (joint 1) and TIM2 (joint 4).
//!
//! Each input has a digital filter, because a motor's lead beside the encoder's cable couples
//! pulses into it. A level counts after six equal samples at an eighth of the timers' 84 MHz, so
//! a pulse shorter than 0.57 µs counts nothing. A true level must then last seven samples,
//! 0.67 µs. At c counts/s a level lasts 2/c, or 1/c if the encoder's edges are unevenly spaced,
//! so the filter follows up to 1 500 000 counts/s: settings that allow more are refused. The
//! benchtop arm needs 1 100 000 at the speed that is a fault (52.5 rad/s, 131 072 counts a turn).
//! Both inputs are delayed alike.

use stm32f4xx_hal::gpio::{Alternate, PA0, PA1, PA15, PB3};
use stm32f4xx_hal::hal_02::Qei as _;
use stm32f4xx_hal::pac::{RCC, TIM2, TIM5};
use stm32f4xx_hal::qei::Qei;

/// The counters.
pub struct Encoders {
    joint1: Qei<TIM5>,
    joint4: Qei<TIM2>,
}

impl Encoders {
    /// Counts joint 1 on PA0 and PA1, joint 4 on PA15 and PB3.
    pub fn new(
        joint1: (TIM5, (PA0<Alternate<2>>, PA1<Alternate<2>>)),
        joint4: (TIM2, (PA15<Alternate<1>>, PB3<Alternate<1>>)),
        rcc: &mut RCC,
    ) -> Self {
        let encoders = Self {
            joint1: Qei::new(joint1.0, joint1.1, rcc),
            joint4: Qei::new(joint4.0, joint4.1, rcc),
        };
        // SAFETY: only the filters are changed, and nothing else writes this register.
        #[allow(unsafe_code)]
        let (timer1, timer4) = unsafe { (&*TIM5::ptr(), &*TIM2::ptr()) };
        timer1
            .ccmr1_input()
            .modify(|_, w| w.ic1f().fdts_div8_n6().ic2f().fdts_div8_n6());
        timer4
            .ccmr1_input()
            .modify(|_, w| w.ic1f().fdts_div8_n6().ic2f().fdts_div8_n6());
        encoders
    }

    /// Both counts, which wrap, latched together: two loads, 60 ns apart, with interrupts masked.
    /// At 1 100 000 counts/s that is 0.07 of a count.
    #[inline]
    pub fn latch(&self) -> [i32; 2] {
        cortex_m::interrupt::free(|_| {
            let (joint1, joint4) = (self.joint1.count(), self.joint4.count());
            [joint1.cast_signed(), joint4.cast_signed()]
        })
    }
}
