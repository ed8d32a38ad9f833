//! The pins that each image has.
//!
//! Inputs that a cable leads to have the chip's own resistor, about 40 kΩ, so that a cable that is
//! off gives a level and no noise: a quiet serial line, encoders that stand still, and an
//! emergency stop that is pressed, even if its own resistor is missing. It is a pull-up but for the
//! drives' fault outputs, whose pull-ups are at the drives: without its wire, the input is low, a
//! fault.

use super::gpio::{self, In, Out, Resistor};
use crate::drivers::boards::{BUILT, CommonPins, Peripheral};

/// The pins of this board.
pub const PINS: CommonPins = BUILT.common;

/// Home switch 1.
pub type Home1 = In<{ PINS.home[0].0 }>;
/// Home switch 4.
pub type Home4 = In<{ PINS.home[1].0 }>;
/// The emergency stop. A timer's break pin can also be read as an input.
pub type Stop = In<{ PINS.stop.0 }>;
/// Releases the brake when high.
pub type Brake = Out<{ PINS.brake.0 }>;

/// Gives the brake's pin and those of the serial line their functions; the brake is engaged.
pub fn set_up() -> Brake {
    let [send, receive] = PINS.serial;
    let brake = gpio::output(false);
    gpio::connect(send, Peripheral::Usart1Send, Resistor::None);
    gpio::connect(receive, Peripheral::Usart1Receive, Resistor::Up);
    brake
}

/// The home switches.
pub fn home() -> (Home1, Home4) {
    (gpio::input(Resistor::Up), gpio::input(Resistor::Up))
}

/// The emergency stop, also TIM1's break input.
pub fn stop_with_break() -> Stop {
    let stop = gpio::input(Resistor::Up);
    gpio::connect(PINS.stop, Peripheral::Tim1Break, Resistor::Up);
    stop
}
