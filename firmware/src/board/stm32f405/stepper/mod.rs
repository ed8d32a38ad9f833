//! Steppers with step/dir drivers: what this image has of its own.
//!
//! TIM4 counts the ticks. Its update raises the tick's interrupt, and starts TIM1 and TIM8 anew, which make the pulses of joints 1
//! and 4. `docs/use/wiring.md` lists the pins.

pub mod outputs;
pub mod pins;
pub mod timers;

use super::clocks::Source;
use super::image::{OnChip, Stm32f405};
use super::post_mortem::reset_after;
use crate::board::end_cause::EndCause;
use crate::board::image::Parts;
use crate::drives::{BlindStepDrives, StepCommand, StepSample};
use crate::protocol::Board;
use crate::settings::BoardLimits;
use crate::{ArmCommand, ArmSample};
use cortex_m::peripheral::SYST;
use outputs::Outputs;
use pins::Switches;
use stm32f4xx_hal::pac::{TIM1, TIM4, TIM8};
use stm32f4xx_hal::rcc::Rcc;

/// The drivers and the switches.
pub struct Stepper {
    switches: Switches,
    outputs: Outputs,
}

impl OnChip for Stepper {
    type Peripherals = (TIM1, TIM8, TIM4);

    fn new(timers: Self::Peripherals, _: Source, rcc: &mut Rcc) -> Self {
        let (outputs, switches) = pins::set_up();
        Self {
            switches,
            outputs: Outputs::new(timers, outputs, rcc),
        }
    }

    fn unpower_until_reset() {
        timers::unpower_until_reset();
    }
}

impl Parts for Stepper {
    type Chip = Stm32f405;
    type Drives = BlindStepDrives;
    const BOARD: Board = Board::Stm32f405Stepper;
    const LIMITS: BoardLimits = BoardLimits::STM32F405_STEPPER;
    const TICK_CYCLES: u32 = timers::TICK_CYCLES;

    fn start(_: Source, _: &mut SYST) {
        timers::start();
    }

    #[inline(always)]
    fn begin(&mut self) -> u32 {
        timers::take_tick();
        timers::since_tick()
    }

    /// The micro-steps that are made at the end of the tick that has begun are the counts, too.
    #[inline(always)]
    fn sample(&mut self, missed: u32, stopped: bool) -> ArmSample<StepSample> {
        let stopped = stopped || self.outputs.timers.is_held();
        let steps = self.outputs.steps(missed);
        let drives = StepSample {
            steps,
            ..StepSample::default()
        };
        self.switches.sample(steps, drives, missed, stopped)
    }

    #[inline(always)]
    fn apply(&mut self, command: &ArmCommand<StepCommand>) {
        self.outputs.apply(command);
    }

    #[inline(always)]
    fn finish(&mut self) {
        self.outputs.timers.rearm_break();
    }

    #[inline(always)]
    fn end(cause: EndCause) -> ! {
        timers::unpower();
        reset_after(cause)
    }
}
