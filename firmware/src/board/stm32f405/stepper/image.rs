//! The production image for steppers: an STM32F405RG that gives the drivers of two motors their steps.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use defmt_rtt as _;
use fivebar_firmware::board::stm32f405::gpio::set_reset;
use fivebar_firmware::board::stm32f405::stepper::pins::PINS;
use fivebar_firmware::board::stm32f405::stepper::timers::ENABLE_PINS;
use fivebar_firmware::drivers::boards::BUILT;

const _: () = if let Err(reason) = BUILT.stepper {
    panic!("{}", reason);
};

fivebar_firmware::stm32f405_image! {
    parts: fivebar_firmware::board::stm32f405::stepper::Stepper,
    peripherals: (TIM1, TIM8, TIM4),
    // At the update that starts the pulses.
    tick: TIM4,
    before_stack: [
        // GPIO_BSRR: the enables high.
        "movw r0, #{low_half}",
        "movt r0, #{high_half}",
        "movw r1, #{enable}",
        "str r1, [r0]",
        // TIM1_BDTR: MOE off.
        "movw r0, #0x0044",
        "movt r0, #0x4001",
        "ldr r1, [r0]",
        "bic r1, r1, #0x8000",
        "str r1, [r0]",
        // TIM8_BDTR: the same.
        "movw r0, #0x0444",
        "movt r0, #0x4001",
        "ldr r1, [r0]",
        "bic r1, r1, #0x8000",
        "str r1, [r0]"
    ],
    operands: [
        low_half = const set_reset(PINS.enable[0]) & 0xffff,
        high_half = const set_reset(PINS.enable[0]) >> 16,
        enable = const ENABLE_PINS,
    ],
    tasks: {
        use core::sync::atomic::Ordering;
        use fivebar_firmware::board::image::STOP;
        use fivebar_firmware::board::stm32f405::stepper::timers;

        /// A break input has stopped the pulses of motor 1; this tells the controller.
        #[task(binds = TIM1_BRK_TIM9, priority = 4)]
        fn tripped1(_: tripped1::Context) {
            if timers::take_break1() {
                STOP.store(true, Ordering::Relaxed);
            }
        }

        /// The same of motor 4.
        #[task(binds = TIM8_BRK_TIM12, priority = 4)]
        fn tripped4(_: tripped4::Context) {
            if timers::take_break4() {
                STOP.store(true, Ordering::Relaxed);
            }
        }
    }
}
