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
use super::image::Parts;
use super::post_mortem::reset_after;
use super::services::OnBoard;
use crate::board::end_cause::EndCause;
use crate::drives::BrushedDrives;
use crate::protocol::Board;
use crate::settings::BoardLimits;
use crate::{ActuatorCommand, SensorSample};
use analog::CurrentsAndBus;
use cortex_m::peripheral::SYST;
use encoders::Encoders;
use outputs::BoardOutputs;
use sensors::Sensors;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, ADC2, TIM1, TIM2, TIM5, TIM8};
use stm32f4xx_hal::rcc::Rcc;

impl OnBoard for BrushedDrives {
    const LIMITS: BoardLimits = BoardLimits::STM32F405;
}

/// The bridges and the sensors.
pub struct Brushed {
    sensors: Sensors,
    outputs: BoardOutputs,
}

impl Parts for Brushed {
    type Drives = BrushedDrives;
    type Peripherals = (TIM1, TIM2, TIM5, TIM8, ADC1, ADC2, ADC_COMMON);
    const BOARD: Board = Board::Stm32f405;
    const TICK_CYCLES: u32 = pwm::TICK_CYCLES;

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
    fn clock_is_wrong(&mut self) -> bool {
        self.outputs.timer.triggers_in_drive_pulse()
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

    fn unpower_until_reset() {
        pwm::unpower_until_reset();
    }

    #[inline(always)]
    fn end(cause: EndCause) -> ! {
        pwm::unpower();
        reset_after(cause)
    }
}
