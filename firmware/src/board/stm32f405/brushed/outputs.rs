//! The outputs of an actuator command: both bridges and their timer.

use super::pins::OutputPins;
use super::pwm::{Channel, PwmTimer};
use crate::ActuatorCommand;
use crate::drivers::Bridge;
use embedded_hal::digital::OutputPin;
use stm32f4xx_hal::gpio::{Output, PB14, PB15};
use stm32f4xx_hal::pac::{RCC, TIM1};

/// The outputs on this board's pins.
pub type BoardOutputs = Outputs<PB14<Output>, PB15<Output>>;

/// The outputs. `Sleep1` and `Sleep4` are the bridges' sleep pins, low asleep.
pub struct Outputs<Sleep1, Sleep4> {
    /// The timer behind both bridges.
    pub timer: PwmTimer,
    /// Joint 1's bridge.
    pub bridge1: Bridge<Channel<0>, Channel<1>, Sleep1>,
    /// Joint 4's bridge.
    pub bridge4: Bridge<Channel<2>, Channel<3>, Sleep4>,
}

impl BoardOutputs {
    /// The outputs: bridges asleep, outputs low.
    pub fn new(timer: TIM1, pins: OutputPins, rcc: &mut RCC) -> Self {
        let (timer, (in1, in2, in3, in4)) = PwmTimer::new(timer, pins.pwm, rcc);
        Self {
            timer,
            bridge1: Bridge::new(in1, in2, pins.sleep1),
            bridge4: Bridge::new(in3, in4, pins.sleep4),
        }
    }
}

impl<Sleep1: OutputPin, Sleep4: OutputPin> Outputs<Sleep1, Sleep4> {
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
