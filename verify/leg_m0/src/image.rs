//! Prints for each place of the foot the instructions of a period, and the bits of what the motors need.
//!
//! Under QEMU's `-icount shift=10` each instruction takes 1024 ns, and SysTick runs at 16 MHz.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::panic::PanicInfo;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprint, hprintln};
use fivebar_kinematics::five_bar::Geometry;
use fivebar_leg_m0::{FEET, GROUND, LENGTHS, VELOCITY, period};

/// SysTick is 24 bits wide: a million instructions.
const WRAP: u32 = 1 << 24;

#[entry]
fn main() -> ! {
    let status = match report() {
        Some(()) => debug::EXIT_SUCCESS,
        None => debug::EXIT_FAILURE,
    };
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}

/// None where something is refused.
fn report() -> Option<()> {
    let mut systick = cortex_m::Peripherals::take()?.SYST;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(WRAP - 1);
    systick.clear_current();
    systick.enable_counter();
    let leg = Geometry::new(LENGTHS).ok()?;
    for foot in FEET {
        // Both barriers are between the counter's reads, and so is what is computed between them.
        let start = SYST::get_current();
        let (leg, inputs) = black_box((&leg, [foot, VELOCITY, GROUND]));
        let motors = black_box(period(leg, inputs));
        let counts = start.wrapping_sub(SYST::get_current()) % WRAP;
        // 16.384 counts each: 125 of 2048.
        let instructions = u64::from(counts) * 125 / 2048;
        let motors = motors.ok()?;
        hprint!("{}", instructions);
        for pair in [motors.angle, motors.rate, motors.torque] {
            let [first, second] = pair.map(f32::to_bits);
            hprint!(" {} {}", first, second);
        }
        hprintln!();
    }
    Some(())
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
