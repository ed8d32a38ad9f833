//! The emulated board's image.
#![no_std]
#![no_main]

use cortex_m_rt::entry;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}

#[entry]
fn main() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
