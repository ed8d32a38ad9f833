//! The function of each pin with bridges.

use crate::board::stm32f405::gpio::{self, In, Out, Resistor};
use crate::board::stm32f405::pins::{self, Home1, Home4, Stop};
use crate::drivers::Inputs;
use crate::drivers::boards::{BUILT, BrushedPins, Peripheral, analog};

/// The pins of this board.
pub const PINS: BrushedPins = BUILT.brushed();

/// The home switches, the encoders' index outputs, the emergency stop and both bridges' fault outputs.
pub type Switches = Inputs<
    Home1,
    Home4,
    In<{ PINS.index[0].0 }>,
    In<{ PINS.index[1].0 }>,
    Stop,
    In<{ PINS.fault[0].0 }>,
    In<{ PINS.fault[1].0 }>,
>;
/// Bridge 1's sleep input; low: asleep.
pub type Sleep1 = Out<{ PINS.sleep[0].0 }>;
/// Bridge 4's sleep input.
pub type Sleep4 = Out<{ PINS.sleep[1].0 }>;

/// Gives each pin its function, the bridges' sleep inputs first: low, asleep.
pub fn set_up() -> ((Sleep1, Sleep4), Switches) {
    let sleep = (gpio::output(false), gpio::output(false));
    for (pin, channel) in PINS.bridges.into_iter().zip(1..) {
        gpio::connect(pin, Peripheral::Tim1(channel), Resistor::None);
    }
    for (pin, channel) in PINS.encoder1.into_iter().zip(1..) {
        gpio::connect(pin, Peripheral::Tim5(channel), Resistor::Up);
    }
    for (pin, channel) in PINS.encoder4.into_iter().zip(1..) {
        gpio::connect(pin, Peripheral::Tim2(channel), Resistor::Up);
    }
    for channel in super::analog::INPUTS {
        gpio::analog(analog(channel));
    }
    let (home1, home4) = pins::home();
    let switches = Inputs {
        home1,
        home4,
        index1: gpio::input(Resistor::Up),
        index4: gpio::input(Resistor::Up),
        emergency_stop: pins::stop_with_break(),
        fault1: gpio::input(Resistor::Down),
        fault4: gpio::input(Resistor::Down),
    };
    (sleep, switches)
}
