//! 168 MHz from the crystal, or 16 MHz from the internal oscillator if that fails or is one that the image does not take.

use super::crystal;
use crate::drivers::crystal::{Crystal, PllFactors};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Rcc, RccExt};

/// How often a ready flag is read before the start of an oscillator counts as failed. One read
/// takes at least 5 cycles of the 16 MHz oscillator, so this is 60 ms or more: a crystal starts
/// within 10 ms, the PLL locks within 0.3 ms.
const TIMEOUT_READS: u32 = 200_000;

/// Cycles of the internal oscillator from one slow tick to the next: 1 kHz.
const SLOW_TICK: u32 = 16_000;

/// What the core runs from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The crystal, through the PLL: 168 MHz.
    Crystal,
    /// The internal oscillator, 16 MHz ± 1 %: the crystal or the PLL did not start, or the crystal
    /// is none that the image takes.
    Internal,
}

/// The clocks as they were started.
#[derive(Clone, Copy, Debug)]
pub struct Clocks {
    /// What the core runs from.
    pub source: Source,
    /// The crystal's frequency [Hz]; none if it did not start or could not be measured.
    pub crystal: Option<u32>,
}

impl Source {
    /// The core's clock [Hz].
    pub fn core(self) -> u32 {
        match self {
            Self::Crystal => 168_000_000,
            Self::Internal => 16_000_000,
        }
    }

    /// Clock of the tool's timer, on the first bus [Hz].
    pub fn tool_timer(self) -> u32 {
        match self {
            // Timers run at twice the clock of a divided bus.
            Self::Crystal => 84_000_000,
            Self::Internal => 16_000_000,
        }
    }

    /// Clock of the peripherals on the second bus, USART1 among them [Hz].
    pub fn second_bus(self) -> u32 {
        match self {
            Self::Crystal => 84_000_000,
            Self::Internal => 16_000_000,
        }
    }
}

/// Starts the clocks.
///
/// The HAL's own start-up waits for a crystal without a bound; here every wait has one. If the
/// crystal fails later, the clock security system switches the core to the internal oscillator,
/// trips the timer's break input and raises the NMI.
pub fn start(mut rcc: pac::RCC, flash: &pac::FLASH, timer: &pac::TIM11) -> (Rcc, Clocks) {
    let crystal = match crystal_starts(&rcc) {
        true => crystal::frequency(timer, &mut rcc),
        false => None,
    };
    let taken = crystal.and_then(Crystal::measured);
    let locks = taken.is_some_and(|taken| pll_locks(&rcc, taken.pll()));
    let source = if locks && core_follows(&rcc, flash) {
        rcc.cr().modify(|_, w| w.csson().on());
        Source::Crystal
    } else {
        rcc.cr()
            .modify(|_, w| w.pllon().clear_bit().hseon().clear_bit());
        rcc.cfgr().modify(|_, w| w.ppre1().div1().ppre2().div1());
        Source::Internal
    };
    (rcc.constrain(), Clocks { source, crystal })
}

/// Lets the core run from the PLL: five wait states of the flash, the buses at 42 and
/// 84 MHz. False if it stays with the internal oscillator.
fn core_follows(rcc: &pac::RCC, flash: &pac::FLASH) -> bool {
    // SAFETY: 5 wait states are what 168 MHz needs at 2.7 V and more.
    #[allow(unsafe_code)]
    flash.acr().modify(|_, w| unsafe {
        w.latency().bits(5);
        w.prften().set_bit().icen().set_bit().dcen().set_bit()
    });
    rcc.cfgr()
        .modify(|_, w| w.hpre().div1().ppre1().div4().ppre2().div2());
    rcc.cfgr().modify(|_, w| w.sw().pll());
    let follows = within_patience(|| rcc.cfgr().read().sws().is_pll());
    if !follows {
        rcc.cfgr().modify(|_, w| w.sw().hsi());
    }
    follows
}

/// Starts the crystal; false if that takes too long.
fn crystal_starts(rcc: &pac::RCC) -> bool {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    within_patience(|| rcc.cr().read().hserdy().bit_is_set())
}

/// Locks the PLL to the crystal; false if that takes too long.
fn pll_locks(rcc: &pac::RCC, factors: PllFactors) -> bool {
    // 336 MHz / 2 = 168 MHz; / 7 = 48 MHz, the limit of the PLL's other output.
    rcc.pllcfgr().modify(|_, w| {
        w.pllsrc().hse();
        // SAFETY: 4 to 25, 168 or 336, and 7 are within the ranges 2..=63, 50..=432 and 2..=15.
        #[allow(unsafe_code)]
        unsafe {
            w.pllm().bits(factors.divider);
            w.plln().bits(factors.multiplier).pllq().bits(7);
        }
        w.pllp().div2()
    });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    within_patience(|| rcc.cr().read().pllrdy().bit_is_set())
}

fn within_patience(ready: impl Fn() -> bool) -> bool {
    (0..TIMEOUT_READS).any(|_| ready())
}

/// Starts SysTick's interrupt at 1 kHz: without a crystal no PWM starts the tick.
pub fn start_slow_tick(systick: &mut SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(SLOW_TICK - 1);
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
}

/// Clears the interrupt of the clock security system: the crystal has failed. The buses then run
/// at the internal oscillator's 16 MHz, undivided.
#[allow(unsafe_code)]
pub fn acknowledge_failure() {
    // SAFETY: writing 1 to the flag clears it; nothing else writes the dividers after the start.
    let rcc = unsafe { &*pac::RCC::ptr() };
    // The other bits, which are zero, would let the clocks' readiness interrupt.
    rcc.cir().write(|w| w.cssc().set_bit());
    rcc.cfgr().modify(|_, w| w.ppre1().div1().ppre2().div1());
}
