//! The production image: an STM32F405RG that drives two motors.
#![no_std]
#![no_main]
#![allow(
    unsafe_code,
    missing_docs,
    reason = "the framework's attribute writes code that needs it"
)]

use defmt_rtt as _;
use fivebar_firmware::board::stm32f405::brushed::pins::PINS;
use fivebar_firmware::board::stm32f405::brushed::pwm::SLEEP_PINS;
use fivebar_firmware::board::stm32f405::gpio::set_reset;
use fivebar_firmware::drivers::boards::BUILT;

const _: () = if let Err(reason) = BUILT.brushed {
    panic!("{}", reason);
};

fivebar_firmware::stm32f405_image! {
    parts: fivebar_firmware::board::stm32f405::brushed::Brushed,
    peripherals: (TIM1, TIM2, TIM5, TIM8, ADC1, ADC2, ADC_COMMON),
    // At the end of the converter's sequence.
    tick: ADC,
    before_stack: [
        // GPIO_BSRR: the sleep inputs low.
        "movw r0, #{low_half}",
        "movt r0, #{high_half}",
        "mov r1, #0",
        "movt r1, #{sleep}",
        "str r1, [r0]",
        // TIM1_BDTR: MOE off.
        "movw r0, #0x0044",
        "movt r0, #0x4001",
        "ldr r1, [r0]",
        "bic r1, r1, #0x8000",
        "str r1, [r0]"
    ],
    operands: [
        low_half = const set_reset(PINS.sleep[0]) & 0xffff,
        high_half = const set_reset(PINS.sleep[0]) >> 16,
        sleep = const SLEEP_PINS,
    ],
    tasks: {
        use core::sync::atomic::Ordering;
        use cortex_m::peripheral::NVIC;
        use fivebar_firmware::board::stm32f405::brushed::{encoders, pwm::PwmTimer};
        use fivebar_firmware::board::image::STOP;
        use stm32f4xx_hal::pac::Interrupt;

        /// The break input has switched the outputs off; this tells the controller.
        #[task(binds = TIM1_BRK_TIM9, priority = 4)]
        fn tripped(_: tripped::Context) {
            if PwmTimer::take_break() {
                STOP.store(true, Ordering::Relaxed);
            }
        }

        /// Latches the encoders and raises the converter's interrupt by software, because the PWM timer does not run.
        #[task(binds = SysTick, priority = 3)]
        fn slow_tick(_: slow_tick::Context) {
            encoders::latch();
            NVIC::pend(Interrupt::ADC);
        }
    }
}
