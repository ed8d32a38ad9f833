//! Brushed motors on H-bridges: what this image has of its own.
//!
//! TIM1 makes the PWM and starts the converters, whose end is the tick; TIM5 and TIM2 count the encoders.
//! `docs/use/wiring.md` lists the pins. Without a crystal the PWM does not start, and SysTick starts the ticks.

pub mod analog;
pub mod encoders;
pub mod outputs;
pub mod pins;
pub mod pwm;
pub mod sensors;

use super::clocks::{self, Source};
use super::image::{CLOCK_FAILED, OnChip, Stm32f405};
use super::post_mortem::reset_after;
use crate::board::end_cause::EndCause;
use crate::board::image::Parts;
use crate::drives::BrushedDrives;
use crate::protocol::Board;
use crate::settings::BoardLimits;
use crate::{ActuatorCommand, SensorSample};
use analog::CurrentsAndBus;
use core::sync::atomic::Ordering;
use cortex_m::peripheral::SYST;
use encoders::Encoders;
use outputs::BoardOutputs;
use sensors::Sensors;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC2, TIM1, TIM2, TIM5, TIM8};
use stm32f4xx_hal::rcc::Rcc;

/// The bridges and the sensors.
pub struct Brushed {
    sensors: Sensors,
    outputs: BoardOutputs,
}

impl OnChip for Brushed {
    type Peripherals = (TIM1, TIM2, TIM5, TIM8, ADC1, ADC2, ADC_COMMON);

    fn new(
        (pwm, encoder4, encoder1, latch, adc1, adc2, common): Self::Peripherals,
        _: Source,
        rcc: &mut Rcc,
    ) -> Self {
        let (sleep, switches) = pins::set_up();
        let outputs = BoardOutputs::new(pwm, sleep, rcc);
        let sensors = Sensors {
            encoders: Encoders::new(&encoder1, &encoder4, &latch, rcc),
            analog: CurrentsAndBus::new((adc1, adc2), &common, rcc),
            switches,
        };
        Self { sensors, outputs }
    }

    fn unpower_until_reset() {
        pwm::unpower_until_reset();
    }
}

impl Parts for Brushed {
    type Chip = Stm32f405;
    type Drives = BrushedDrives;
    const BOARD: Board = Board::Stm32f405;
    const LIMITS: BoardLimits = BoardLimits::STM32F405;
    const TICK_CYCLES: u32 = pwm::TICK_CYCLES;

    fn start(source: Source, systick: &mut SYST) {
        match source {
            Source::Crystal => pwm::start(),
            Source::Internal => clocks::start_slow_tick(systick),
        }
    }

    #[inline(always)]
    fn begin(&mut self) -> u32 {
        self.outputs.timer.since_trigger()
    }

    #[inline(always)]
    fn check_clock(&mut self) {
        if self.outputs.timer.triggers_in_drive_pulse() {
            CLOCK_FAILED.store(true, Ordering::Relaxed);
        }
    }

    #[inline(always)]
    fn sample(&mut self, missed: u32, stopped: bool) -> SensorSample {
        self.sensors.sample(missed, stopped)
    }

    #[inline(always)]
    fn apply(&mut self, command: &ActuatorCommand) {
        self.outputs.apply(command);
    }

    #[inline(always)]
    fn finish(&mut self) {
        self.outputs.timer.rearm_break();
    }

    #[inline(always)]
    fn end(cause: EndCause) -> ! {
        pwm::unpower();
        reset_after(cause)
    }
}
