//! The outputs of an actuator command: both bridges and their timer.

use super::pins::{Sleep1, Sleep4};
use super::pwm::{Channel, PwmTimer};
use crate::ActuatorCommand;
use crate::drivers::Bridge;
use embedded_hal::digital::OutputPin;
use stm32f4xx_hal::pac::{RCC, TIM1};

/// The outputs on this board's pins.
pub type BoardOutputs = Outputs<Sleep1, Sleep4>;

/// The outputs. `S1` and `S4` are the bridges' sleep pins, low asleep.
pub struct Outputs<S1, S4> {
    /// The timer behind both bridges.
    pub timer: PwmTimer,
    /// Joint 1's bridge.
    pub bridge1: Bridge<Channel<0>, Channel<1>, S1>,
    /// Joint 4's bridge.
    pub bridge4: Bridge<Channel<2>, Channel<3>, S4>,
}

impl BoardOutputs {
    /// The outputs: bridges asleep, outputs low.
    pub fn new(timer: TIM1, (sleep1, sleep4): (Sleep1, Sleep4), rcc: &mut RCC) -> Self {
        let (timer, (in1, in2, in3, in4)) = PwmTimer::new(timer, rcc);
        Self {
            timer,
            bridge1: Bridge::new(in1, in2, sleep1),
            bridge4: Bridge::new(in3, in4, sleep4),
        }
    }
}

impl<S1: OutputPin, S4: OutputPin> Outputs<S1, S4> {
    /// Applies an actuator command, from the timer's next update on.
    #[inline]
    pub fn apply(&mut self, command: &ActuatorCommand) {
        let [enable1, enable4] = command.enable;
        let [duty1, duty4] = command.drives.duty;
        if enable1 {
            self.bridge1.drive(duty1);
        } else {
            self.bridge1.float();
        }
        if enable4 {
            self.bridge4.drive(duty4);
        } else {
            self.bridge4.float();
        }
        self.timer.power(enable1 || enable4);
    }
}
