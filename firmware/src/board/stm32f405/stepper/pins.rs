//! The function of each pin with stepper drivers.
//!
//! The enables are low when a driver has power, and each driver has a
//! resistor that pulls its enable high: while the chip is in reset, or its cable is off, the motors have no power.

use crate::board::stm32f405::gpio::{self, In, Out, Resistor};
use crate::board::stm32f405::pins::{self, Home1, Home4, Stop};
use crate::drivers::boards::{BUILT, Peripheral, StepperPins};
use crate::drivers::{Inputs, Level};

/// The pins of this board.
pub const PINS: StepperPins = BUILT.stepper();

/// The home switches, the emergency stop and both drivers' fault outputs.
pub type Switches = Inputs<
    Home1,
    Home4,
    Level<false>,
    Level<false>,
    Stop,
    In<{ PINS.fault[0].0 }>,
    In<{ PINS.fault[1].0 }>,
>;
/// Direction of motor 1: high is forwards.
pub type Direction1 = Out<{ PINS.direction[0].0 }>;
/// Direction of motor 4.
pub type Direction4 = Out<{ PINS.direction[1].0 }>;
/// Enable of driver 1: low has power.
pub type Enable1 = Out<{ PINS.enable[0].0 }>;
/// Enable of driver 4.
pub type Enable4 = Out<{ PINS.enable[1].0 }>;

/// The pins of the outputs.
pub struct OutputPins {
    /// The directions; low.
    pub direction: (Direction1, Direction4),
    /// The enables; high.
    pub enable: (Enable1, Enable4),
}

/// Gives each pin its function, the enables first: high, no power.
pub fn set_up() -> (OutputPins, Switches) {
    let enable = (gpio::output(true), gpio::output(true));
    let [step1, step4] = PINS.step;
    gpio::connect(step1, Peripheral::Tim1(1), Resistor::None);
    gpio::connect(step4, Peripheral::Tim8, Resistor::None);
    gpio::connect(PINS.stop4, Peripheral::Tim8Break, Resistor::Up);
    let outputs = OutputPins {
        direction: (gpio::output(false), gpio::output(false)),
        enable,
    };
    let (home1, home4) = pins::home();
    let switches = Inputs {
        home1,
        home4,
        index1: Level,
        index4: Level,
        emergency_stop: pins::stop_with_break(),
        fault1: gpio::input(Resistor::Down),
        fault4: gpio::input(Resistor::Down),
    };
    (outputs, switches)
}
