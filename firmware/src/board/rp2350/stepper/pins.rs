//! The pins of stepper drivers. `docs/use/wiring.md` has the same table.
//!
//! The enables are low when a driver has power, and each driver has a resistor that pulls its enable high: while the chip is in
//! reset, or its cable is off, the motors have no power.

use crate::board::rp2350::pins::{In, Out, Pins, Stop};
use crate::drivers::{Inputs, Level};
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin};

/// The directions of motors 1 and 4: high is forwards.
pub const DIRECTION: [usize; 2] = [7, 8];
/// The enables of drivers 1 and 4: low has power.
pub const ENABLE: [usize; 2] = [9, 10];
/// The home switches of joints 1 and 4: high is pressed.
pub const HOME: [usize; 2] = [11, 12];
/// The fault outputs of drivers 1 and 4: high is a fault.
pub const FAULT: [usize; 2] = [13, 14];

/// A fault output that is high in a fault, and so is a broken wire.
pub struct FaultOutput<const PIN: usize>(In<PIN>);

/// The home switches, the emergency stop and both drivers' fault outputs.
pub type Switches = Inputs<
    In<{ HOME[0] }>,
    In<{ HOME[1] }>,
    Level<false>,
    Level<false>,
    Stop,
    FaultOutput<{ FAULT[0] }>,
    FaultOutput<{ FAULT[1] }>,
>;

/// The pins of the outputs.
pub struct OutputPins {
    /// The directions.
    pub direction: (Out<{ DIRECTION[0] }>, Out<{ DIRECTION[1] }>),
    /// The enables.
    pub enable: (Out<{ ENABLE[0] }>, Out<{ ENABLE[1] }>),
}

/// Gives each pin its function, the enables first: high, no power.
pub fn set_up(pins: &Pins<'_>) -> (OutputPins, Switches) {
    let outputs = OutputPins {
        enable: (pins.output(true), pins.output(true)),
        direction: (pins.output(false), pins.output(false)),
    };
    let switches = Inputs {
        home1: pins.input(),
        home4: pins.input(),
        index1: Level,
        index4: Level,
        emergency_stop: pins.input(),
        fault1: FaultOutput(pins.input()),
        fault4: FaultOutput(pins.input()),
    };
    (outputs, switches)
}

impl<const PIN: usize> ErrorType for FaultOutput<PIN> {
    type Error = Infallible;
}

/// As the controller expects it: low is a fault.
impl<const PIN: usize> InputPin for FaultOutput<PIN> {
    #[inline]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        self.0.is_low()
    }

    #[inline]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.0.is_high()
    }
}
