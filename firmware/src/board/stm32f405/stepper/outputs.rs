//! The outputs of an actuator command for stepper drivers: pulses, directions and enables.

use super::pins::{Direction1, Direction4, Enable1, Enable4, OutputPins};
use super::timers::StepTimers;
use crate::ArmCommand;
use crate::drivers::steps::{Pulses, StepAxis};
use crate::drives::StepCommand;
use stm32f4xx_hal::pac::{RCC, TIM1, TIM4, TIM8};

/// The outputs.
pub struct Outputs {
    /// The timers of the pulses.
    pub timers: StepTimers,
    axes: [StepAxis; 2],
    direction1: Direction1,
    direction4: Direction4,
    enable1: Enable1,
    enable4: Enable4,
}

impl Outputs {
    /// The outputs: no pulses, motors without power.
    pub fn new(
        (timer1, timer4, ticks): (TIM1, TIM8, TIM4),
        pins: OutputPins,
        rcc: &mut RCC,
    ) -> Self {
        Self {
            timers: StepTimers::new(timer1, timer4, &ticks, rcc),
            axes: Default::default(),
            direction1: pins.direction.0,
            direction4: pins.direction.1,
            enable1: pins.enable.0,
            enable4: pins.enable.1,
        }
    }

    /// The micro-steps that are made at the end of the tick that has begun, `missed` ticks after the last one.
    #[inline]
    pub fn steps(&mut self, missed: u32) -> [i32; 2] {
        let [taken1, taken4] = self.timers.taken();
        let [axis1, axis4] = &mut self.axes;
        [axis1.begin(taken1, missed), axis4.begin(taken4, missed)]
    }

    /// Applies an actuator command: pulses from the next tick on, the rest at once.
    #[inline]
    pub fn apply(&mut self, command: &ArmCommand<StepCommand>) {
        let [enable1, enable4] = command.enable;
        let [axis1, axis4] = &mut self.axes;
        let [steps1, steps4] = command.drives.steps;
        let pulses = [
            axis1.prepare(if enable1 { steps1 } else { 0 }),
            axis4.prepare(if enable4 { steps4 } else { 0 }),
        ]
        .map(Pulses::of);
        self.direction1.write(axis1.forwards());
        self.direction4.write(axis4.forwards());
        self.enable1.write(!enable1);
        self.enable4.write(!enable4);
        self.timers.power(enable1 || enable4);
        self.timers.prepare(pulses);
    }
}
