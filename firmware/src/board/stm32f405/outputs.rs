//! The outputs of an actuator command: both bridges, their timer, the brake and the tool.

use super::pins::OutputPins;
use super::pwm::{Channel, PwmTimer};
use super::tool::ToolChannel;
use crate::ActuatorCommand;
use crate::drivers::Bridge;
use embedded_hal::digital::OutputPin;
use stm32f4xx_hal::gpio::{Output, PB14, PB15, PC6};
use stm32f4xx_hal::pac::{RCC, TIM1};

/// The outputs on this board's pins.
pub type BoardOutputs = Outputs<PB14<Output>, PB15<Output>, PC6<Output>>;

/// The outputs. `Sleep1` and `Sleep4` are the bridges' sleep pins, low asleep; `Brake`
/// releases the holding brake when high.
pub struct Outputs<Sleep1, Sleep4, Brake> {
    /// The timer behind both bridges.
    pub timer: PwmTimer,
    /// Joint 1's bridge.
    pub bridge1: Bridge<Channel<0>, Channel<1>, Sleep1>,
    /// Joint 4's bridge.
    pub bridge4: Bridge<Channel<2>, Channel<3>, Sleep4>,
    /// The holding brake.
    pub brake: Brake,
    /// The tool.
    pub tool: ToolChannel,
}

impl BoardOutputs {
    /// The outputs: bridges asleep, outputs low, brake engaged.
    pub fn new(timer: TIM1, pins: OutputPins, tool: ToolChannel, rcc: &mut RCC) -> Self {
        let (timer, (in1, in2, in3, in4)) = PwmTimer::new(timer, pins.pwm, rcc);
        Self {
            timer,
            bridge1: Bridge::new(in1, in2, pins.sleep1),
            bridge4: Bridge::new(in3, in4, pins.sleep4),
            brake: pins.brake,
            tool,
        }
    }
}

impl<Sleep1: OutputPin, Sleep4: OutputPin, Brake: OutputPin> Outputs<Sleep1, Sleep4, Brake> {
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
        // A pin of this chip cannot fail to be written.
        let _ = self.brake.set_state((!command.brake).into());
        self.tool.set(command.tool);
    }
}
