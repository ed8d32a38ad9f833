//! TIM5 counts the ticks: 1 kHz, as the bus allows.

use stm32f4xx_hal::pac::{RCC, TIM5};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// Cycles of the core from one tick to the next.
pub const TICK_CYCLES: u32 = 168_000;
/// Clocks of TIM5, at half the clock of the core, from one tick to the next.
const TICK_COUNTS: u32 = TICK_CYCLES / 2;
/// The flags of the status register.
const FLAGS: u32 = 0x1e5f;

/// Programs the timer: no ticks yet.
pub fn set_up(timer: &TIM5, rcc: &mut RCC) {
    TIM5::enable(rcc);
    TIM5::reset(rcc);
    timer.arr().write(|w| w.arr().set(TICK_COUNTS - 1));
    timer.dier().write(|w| w.uie().enabled());
}

/// Lets the ticks begin. Called once, when interrupts are enabled.
pub fn start() {
    // SAFETY: after its setup, nothing else writes this register.
    #[allow(unsafe_code)]
    unsafe {
        (*TIM5::ptr()).cr1().modify(|_, w| w.cen().enabled());
    }
}

/// Cycles since the update that raised the tick's interrupt.
#[inline]
pub fn since_tick() -> u32 {
    // SAFETY: the counter is only read.
    #[allow(unsafe_code)]
    let count = unsafe { (*TIM5::ptr()).cnt().read().bits() };
    2 * count
}

/// Takes the interrupt's flag of the tick.
#[inline]
pub fn take_tick() {
    // SAFETY: a flag is cleared by writing 0 to it; nothing else writes the register.
    #[allow(unsafe_code)]
    unsafe {
        (*TIM5::ptr())
            .sr()
            .write(|w| w.bits(FLAGS).uif().clear_bit());
    }
}
