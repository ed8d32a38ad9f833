//! The tick alone, to prove that it cannot panic or allocate. This image is linked and inspected,
//! and never run.
//!
//! Its panic handler calls a function that does not exist. The linker drops unreachable code, so
//! the image links only if no panic is reachable from the tick. It has no allocator, so code that
//! allocates does not link. `tests/tests/images.rs` checks its symbols for double-precision and
//! library arithmetic.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    reason = "the tick's arguments are at an address that the compiler does not know"
)]

use core::panic::PanicInfo;
use core::ptr;
use cortex_m_rt::entry;
use fivebar_firmware::{ActuatorCommand, Controller, SensorSample};
use stm32f4xx_hal as _;

/// An address whose contents the compiler does not know.
const SOMEWHERE: *const *mut (Controller, SensorSample, ActuatorCommand) =
    ptr::without_provenance(0x2000_0000);

#[entry]
fn main() -> ! {
    // SAFETY: none; this program is not run. The volatile read hides the values of the controller and
    // its sample from the compiler.
    let (controller, sample, command) = unsafe { &mut *ptr::read_volatile(SOMEWHERE) };
    *command = controller.tick(sample);
    // Not around the tick: its constants would be loaded before the loop.
    loop {}
}

unsafe extern "C" {
    fn the_tick_can_panic() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: it does not exist; see above.
    unsafe { the_tick_can_panic() }
}
