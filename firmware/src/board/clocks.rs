//! 168 MHz from the 8 MHz crystal, or 16 MHz from the internal oscillator if that fails.

use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Config, Rcc, RccExt};
use stm32f4xx_hal::time::Hertz;

/// The crystal between PH0 and PH1 [Hz].
const CRYSTAL: u32 = 8_000_000;
/// The core's clock when the crystal runs [Hz].
const CORE: u32 = 168_000_000;

/// How often a ready flag is looked at before the oscillator is given up. One look takes
/// at least 5 cycles of the 16 MHz oscillator, so this is 60 ms or more: a crystal starts
/// within 10 ms, the PLL locks within 0.3 ms.
const PATIENCE: u32 = 200_000;

/// What the core runs from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The crystal, through the PLL.
    Crystal,
    /// The internal oscillator, 16 MHz ± 1 %: the crystal or the PLL did not start.
    Internal,
}

/// Starts the clocks.
///
/// The crystal and the PLL are brought up here, where waiting has a bound; the HAL, which
/// waits for ever, then finds both ready. A crystal that dies later is caught by the clock
/// security system: the core goes on from the internal oscillator, the timers' break
/// input trips and the NMI is raised.
pub fn start(rcc: pac::RCC) -> (Rcc, Source) {
    if crystal_runs(&rcc) {
        let config = Config::hse(Hertz::from_raw(CRYSTAL)).sysclk(Hertz::from_raw(CORE));
        let frozen = rcc.freeze(config);
        frozen.cr().modify(|_, w| w.csson().on());
        (frozen, Source::Crystal)
    } else {
        rcc.cr()
            .modify(|_, w| w.pllon().clear_bit().hseon().clear_bit());
        (rcc.freeze(Config::hsi()), Source::Internal)
    }
}

/// Starts the crystal and locks the PLL to it; false if either takes too long.
fn crystal_runs(rcc: &pac::RCC) -> bool {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    if !within_patience(|| rcc.cr().read().hserdy().bit_is_set()) {
        return false;
    }
    // 8 MHz / 4 · 168 / 2 = 168 MHz. The HAL may find other factors for the same clock;
    // it cannot change these while the PLL runs.
    rcc.pllcfgr().modify(|_, w| {
        w.pllsrc().hse();
        // SAFETY: 4 and 168 are within the ranges 2..=63 and 50..=432.
        #[allow(unsafe_code)]
        unsafe {
            w.pllm().bits(4).plln().bits(168);
        }
        w.pllp().div2()
    });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    within_patience(|| rcc.cr().read().pllrdy().bit_is_set())
}

fn within_patience(ready: impl Fn() -> bool) -> bool {
    (0..PATIENCE).any(|_| ready())
}

/// Takes the clock security system's interrupt: the crystal has died.
#[allow(unsafe_code)]
pub fn acknowledge_failure() {
    // SAFETY: writing 1 to this flag clears it and touches nothing else; the handler of
    // the interrupt that nothing can mask owns nothing.
    unsafe {
        (*pac::RCC::ptr()).cir().modify(|_, w| w.cssc().set_bit());
    }
}
