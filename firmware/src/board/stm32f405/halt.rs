//! What goes on while a debugger halts the core.
//!
//! The peripherals do not stop with the core: without more the timers would repeat their last duties or pulses, the tool
//! its last power, and the brake would stay released.
//!
//! TIM1 and TIM8 stop, and their outputs are disabled as if MOE were cleared (RM0090, 38.16.2 and 38.16.5): with the idle
//! states of the drivers here the bridges' inputs and the step pins are low at once. TIM4 stops with them, so that no tick
//! begins. The frames of the bus that wait in the mailboxes are sent, then none; the drives' own watchdogs end the torque.
//!
//! Everything else ends with the chip's watchdog, which counts on: it resets the chip 34 to 94 ms after its last refresh,
//! and all pins float. The start-up scripts of debuggers stop it for halts, so each refresh takes that back.

use stm32f4xx_hal::pac::DBGMCU;

/// Sets what stops with the core. The registers keep it over every reset but power-up.
pub fn prepare(debug: &DBGMCU) {
    debug
        .apb1_fz()
        .modify(|_, w| w.dbg_tim4_stop().set_bit().dbg_iwdg_stop().clear_bit());
    debug
        .apb2_fz()
        .modify(|_, w| w.dbg_tim1_stop().set_bit().dbg_tim8_stop().set_bit());
}

/// The watchdog counts in the next halt, too, whatever a debugger has set meanwhile.
#[inline]
pub fn keep_watchdog_counting() {
    // SAFETY: after the start only the caller, the watchdog's refresh, and a debugger write this register.
    #[allow(unsafe_code)]
    let debug = unsafe { &*DBGMCU::ptr() };
    debug.apb1_fz().modify(|_, w| w.dbg_iwdg_stop().clear_bit());
}
