//! 150 MHz from the crystal of 12 MHz, and 48 MHz for USB.

use super::resets;
use rp235x_pac::{CLOCKS, PLL_SYS, PLL_USB, RESETS, TICKS, XOSC, pll_sys};

/// The core's clock, and that of the serial line and the PIO [Hz].
pub const CORE: u32 = 150_000_000;
/// The crystal, in megahertz: the ticks of the watchdog are its clocks over this, 1 µs.
const CRYSTAL_MHZ: u8 = 12;
/// 12 MHz · 125 = 1500 MHz, over 5 and 2.
const MULTIPLIER: u16 = 125;
const DIVIDERS: [u8; 2] = [5, 2];
/// 12 MHz · 100 = 1200 MHz, over 5 and 5.
const USB_MULTIPLIER: u16 = 100;
const USB_DIVIDERS: [u8; 2] = [5, 5];
/// Start-up time of the crystal in 256 of its clocks: 1 ms, times 6.
const START_UP: u16 = 47 * 6;
/// The code that switches the oscillator on (it needs one of these, not a bit).
const FREQUENCY_RANGE: u16 = 0xaa0;
const ENABLE: u16 = 0xfab;
/// How often a flag is read before a start counts as failed. A read takes 3 cycles or more of 15 MHz at most: over 40 ms.
const TIMEOUT_READS: u32 = 200_000;

/// What was not ready in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, defmt::Format)]
pub enum ClockError {
    /// The crystal does not swing.
    Crystal,
    /// The PLL does not lock to it.
    Pll,
    /// The core does not follow.
    Switch,
}

/// Starts the clocks.
///
/// # Errors
/// What was not ready in time; the core then runs from its ring oscillator, whose frequency nobody knows.
pub fn start(
    xosc: &XOSC,
    pll: &PLL_SYS,
    clocks: &CLOCKS,
    ticks: &TICKS,
    resets: &RESETS,
) -> Result<(), ClockError> {
    // SAFETY: the values are those of the data sheet for these fields.
    #[allow(unsafe_code)]
    unsafe {
        xosc.startup().write(|w| w.delay().bits(START_UP));
        xosc.ctrl()
            .write(|w| w.bits(u32::from(ENABLE) << 12 | u32::from(FREQUENCY_RANGE)));
    }
    within_patience(|| xosc.status().read().stable().bit_is_set()).ok_or(ClockError::Crystal)?;
    // The boot ROM may have left the core on the PLL that is set up anew here.
    clocks.clk_sys_ctrl().modify(|_, w| w.src().clk_ref());
    within_patience(|| clocks.clk_sys_selected().read().bits() == 1).ok_or(ClockError::Switch)?;
    clocks.clk_ref_ctrl().modify(|_, w| w.src().xosc_clksrc());
    within_patience(|| clocks.clk_ref_selected().read().bits() == 1 << 2)
        .ok_or(ClockError::Switch)?;

    resets::reset(resets, resets::PLL_SYS);
    lock(pll, MULTIPLIER, DIVIDERS)?;
    clocks
        .clk_sys_ctrl()
        .modify(|_, w| w.auxsrc().clksrc_pll_sys().src().clksrc_clk_sys_aux());
    within_patience(|| clocks.clk_sys_selected().read().bits() == 1 << 1)
        .ok_or(ClockError::Switch)?;
    clocks
        .clk_peri_ctrl()
        .write(|w| w.auxsrc().clk_sys().enable().set_bit());
    let tick = ticks.tickwatchdog();
    // SAFETY: 9 bits are any number of cycles.
    #[allow(unsafe_code)]
    tick.cycles()
        .write(|w| unsafe { w.bits(u32::from(CRYSTAL_MHZ)) });
    tick.ctrl().write(|w| w.enable().set_bit());
    Ok(())
}

/// Starts the clock of USB, behind the others.
///
/// # Errors
/// If its PLL does not lock; only USB needs it.
pub fn start_usb(pll: &PLL_USB, clocks: &CLOCKS, resets: &RESETS) -> Result<(), ClockError> {
    resets::reset(resets, resets::PLL_USB);
    lock(pll, USB_MULTIPLIER, USB_DIVIDERS)?;
    clocks
        .clk_usb_ctrl()
        .write(|w| w.auxsrc().clksrc_pll_usb().enable().set_bit());
    Ok(())
}

/// Lets a PLL swing with this multiple of the crystal, and divides it.
fn lock(
    pll: &pll_sys::RegisterBlock,
    multiplier: u16,
    [first, second]: [u8; 2],
) -> Result<(), ClockError> {
    // SAFETY: the values are those of the data sheet for these fields.
    #[allow(unsafe_code)]
    unsafe {
        pll.cs().write(|w| w.refdiv().bits(1));
        pll.fbdiv_int().write(|w| w.fbdiv_int().bits(multiplier));
        pll.pwr()
            .modify(|_, w| w.pd().clear_bit().vcopd().clear_bit());
    }
    within_patience(|| pll.cs().read().lock().bit_is_set()).ok_or(ClockError::Pll)?;
    // SAFETY: as above.
    #[allow(unsafe_code)]
    pll.prim()
        .write(|w| unsafe { w.postdiv1().bits(first).postdiv2().bits(second) });
    pll.pwr().modify(|_, w| w.postdivpd().clear_bit());
    Ok(())
}

fn within_patience(ready: impl Fn() -> bool) -> Option<()> {
    (0..TIMEOUT_READS).any(|_| ready()).then_some(())
}
