//! The brown-out reset, at its highest level.
//!
//! 168 MHz with five wait states needs 2.7 V, and the chip leaves the factory with the brown-out
//! reset off: it would run on down to 1.8 V. With the reset on, the pins float and the bridges are
//! off before the program can go wrong.

use stm32f4xx_hal::pac::FLASH;

/// What the option bytes' key register expects.
const KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];
/// The option bytes' code of level 3: reset below 2.7 V. The codes count down (RM0090: 0 is level
/// 3, 3 is off), other than the names in the peripheral access crate.
const LEVEL_3: u8 = 0;
/// How often the busy flag is read before the operation counts as failed: over 1 s.
const TIMEOUT_READS: u32 = 50_000_000;

/// Programs the option bytes once in the life of a chip. The level holds from the next reset on.
/// Programming stalls the core for up to a second, so this is for the start only, before the
/// watchdog runs. Returns the code of the level that was found: 0 is the highest, 3 is off. What was
/// programmed shows at the next start.
pub fn enable_reset(flash: &FLASH) -> u8 {
    let found = flash.optcr().read().bor_lev().bits();
    if found == LEVEL_3 {
        return found;
    }
    for key in KEYS {
        // SAFETY: the keys in this sequence unlock the register.
        #[allow(unsafe_code)]
        flash.optkeyr().write(|w| unsafe { w.bits(key) });
    }
    // SAFETY: 2 bits are any level.
    #[allow(unsafe_code)]
    flash
        .optcr()
        .modify(|_, w| unsafe { w.bor_lev().bits(LEVEL_3) });
    flash.optcr().modify(|_, w| w.optstrt().set_bit());
    // If it fails, the next start tries again.
    let _ = (0..TIMEOUT_READS).any(|_| flash.sr().read().bsy().bit_is_clear());
    flash.optcr().modify(|_, w| w.optlock().set_bit());
    found
}
