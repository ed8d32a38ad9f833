//! The pins that each image has, and what stands in the place of those that it does not have.
//!
//! Inputs that a cable leads to have the chip's own resistor, about 40 kΩ, so that a cable that is
//! off gives a level and no noise: a quiet serial line, encoders that stand still, and an
//! emergency stop that is pressed, even if its own resistor is missing. It is a pull-up but for the
//! drives' fault outputs, whose pull-ups are at the drives: without its wire, the input is low, a
//! fault.

use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin};
use stm32f4xx_hal::gpio::{Alternate, Input, Output, PB6, PB7, PC6, PC7, PinPull, Pull};

/// The brake, the tool and the serial line.
pub struct CommonPins {
    /// Releases the brake when high; low.
    pub brake: PC6<Output>,
    /// The tool's output, floating.
    pub tool: PC7<Input>,
    /// The serial line: out, in.
    pub serial: (PB6<Alternate<7>>, PB7<Alternate<7>>),
}

impl CommonPins {
    /// Gives each pin its function.
    pub fn new(serial: (PB6, PB7), brake: PC6, tool: PC7) -> Self {
        let (send, receive) = serial;
        Self {
            brake: brake.into_push_pull_output(),
            tool,
            serial: (send.into_alternate(), pulled_up(receive.into_alternate())),
        }
    }
}

/// In the place of an input that the drives do not have: an index output without a pulse, a fault output without a fault.
pub struct Level<const HIGH: bool>;

impl<const HIGH: bool> ErrorType for Level<HIGH> {
    type Error = Infallible;
}

impl<const HIGH: bool> InputPin for Level<HIGH> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(HIGH)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!HIGH)
    }
}

/// The pin with the chip's pull-up.
pub fn pulled_up<Pin: PinPull>(pin: Pin) -> Pin {
    pin.internal_resistor(Pull::Up)
}
