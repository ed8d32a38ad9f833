//! The production image for steppers: an STM32F405RG that gives the drivers of two motors their steps.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use defmt_rtt as _;

fivebar_firmware::image! {
    parts: fivebar_firmware::board::stm32f405::stepper::Stepper,
    peripherals: (GPIOA, GPIOB, GPIOC, TIM1, TIM8, TIM4),
    // At the update that starts the pulses.
    tick: TIM4,
    before_stack: [
        // GPIOB_BSRR: PB14 and PB15 high.
        "movw r0, #0x0418",
        "movt r0, #0x4002",
        "mov r1, #0xc000",
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
    tasks: {
        use core::sync::atomic::Ordering;
        use fivebar_firmware::board::stm32f405::image::STOP;
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
