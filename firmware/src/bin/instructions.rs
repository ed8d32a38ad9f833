//! The instruction benchmark.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use fivebar_firmware::board::emulated::InstructionCounter;
use fivebar_kinematics::Vec2;
use fivebar_kinematics::five_bar::*;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}

#[entry]
fn main() -> ! {
    let p = cortex_m::Peripherals::take().unwrap();
    let c = InstructionCounter::new(p.SYST);
    let g = Geometry::new([0.23f32, 0.23, 0.23, 0.23, 0.275]).unwrap();
    let g = black_box(g);
    let start = c.now();
    for _ in 0..1000 {
        let _ = black_box(
            g.inverse(black_box(Vec2::new(0.1, 0.3)), WorkingMode::ALL[1])
                .map(|p| [p.u1.angle(), p.u4.angle()]),
        );
    }
    hprintln!("{}", c.since(start));
    debug::exit(debug::EXIT_SUCCESS);
    loop {}
}
