//! The tick alone, to prove what is not in it. This image is linked, inspected and never
//! run.
//!
//! Its panic handler calls a function that does not exist: if any panic can be reached
//! from the tick once the linker has dropped what cannot, the image does not link. It has
//! no allocator, so nothing that allocates links either. `tests/tests/images.rs`
//! looks through its symbols for double-precision and library arithmetic.
#![no_std]
#![no_main]
#![allow(unsafe_code, reason = "the tick's arguments come from nowhere")]

use core::panic::PanicInfo;
use core::ptr;
use cortex_m_rt::entry;
use fivebar_firmware::{Command, Controller, Sensed};
use stm32f4xx_hal as _;

/// An address that the compiler knows nothing about.
const SOMEWHERE: *const *mut (Controller, Sensed, Command) = ptr::without_provenance(0x2000_0000);

#[entry]
fn main() -> ! {
    loop {
        // SAFETY: none; this program is not run. The volatile read keeps the compiler
        // from knowing anything about the controller and its samples.
        let (controller, sensed, command) = unsafe { &mut *ptr::read_volatile(SOMEWHERE) };
        *command = controller.tick(sensed);
    }
}

unsafe extern "C" {
    fn the_tick_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: it does not exist; see above.
    unsafe { the_tick_can_panic() }
}
