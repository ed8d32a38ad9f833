//! The crystal's frequency, measured against the internal oscillator.
//!
//! With another crystal than the clock is set up for everything would run at another speed: the core beyond its
//! limit, the tick, the PWM, the serial line. TIM11 can capture the crystal's clock, divided as for
//! the RTC (RM0090, TIM11_OR), while the core and the timer still run from the internal oscillator;
//! the chip's own ROM loader measures its crystal so, too.

use stm32f4xx_hal::pac::{RCC, TIM11};
use stm32f4xx_hal::rcc::{Enable, Reset};

/// The crystal's clock is divided by this before the timer's input, 31 at most.
const DIVIDER: u8 = 31;
/// The timer's input prescaler: a capture at every eighth edge.
const EVERY_EIGHTH: u8 = 3;
const EDGES: u32 = 8;
/// TIM11's input: the crystal's divided clock.
const CRYSTAL_INPUT: u8 = 2;
/// The internal oscillator [Hz].
const INTERNAL: u32 = 16_000_000;
/// How often the flag of a capture is looked at: 10 ms or more, and a capture takes 0.1 ms with a
/// crystal of 4 MHz.
const TIMEOUT_READS: u32 = 30_000;

/// The running crystal's frequency [Hz]; none if two captures in a row did not come or were not read in
/// time. The core must run from the internal oscillator, with the second bus undivided.
pub fn frequency(timer: &TIM11, rcc: &mut RCC) -> Option<u32> {
    TIM11::enable(rcc);
    TIM11::reset(rcc);
    // SAFETY: the divider is 2 to 31; 2 bits are any input and any prescaler.
    #[allow(unsafe_code)]
    unsafe {
        rcc.cfgr().modify(|_, w| w.rtcpre().bits(DIVIDER));
        timer.or().write(|w| w.rmp().bits(CRYSTAL_INPUT));
        timer
            .ccmr1_input()
            .write(|w| w.cc1s().ti1().ic1psc().bits(EVERY_EIGHTH));
    }
    timer.ccer().write(|w| w.cc1e().set_bit());
    timer.cr1().write(|w| w.cen().enabled());
    let captures = [capture(timer), capture(timer)];
    let overtaken = timer.sr().read().cc1of().bit_is_set();
    TIM11::reset(rcc);
    TIM11::disable(rcc);
    let [Some(first), Some(second)] = captures else {
        return None;
    };
    let counts = u32::from(second.wrapping_sub(first));
    (!overtaken && counts > 0).then(|| INTERNAL / counts * (u32::from(DIVIDER) * EDGES))
}

/// The counter at the next capture; none if it does not come. Reading it clears the flag.
fn capture(timer: &TIM11) -> Option<u16> {
    (0..TIMEOUT_READS)
        .any(|_| timer.sr().read().cc1if().bit_is_set())
        .then(|| timer.ccr1().read().ccr().bits())
}
