//! The function of each pin with drives on a CAN bus: the table of `docs/use/wiring.md` as types.
//!
//! The inputs' resistors are those of the image for brushed motors. Without its transceiver the bus reads recessive, by the
//! pull-up at PB8.

use crate::drivers::Inputs;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin};
use stm32f4xx_hal::gpio::{
    Alternate, Input, Output, PB6, PB7, PB8, PB9, PB12, PC4, PC5, PC6, PC7, PinPull, Pull,
};
use stm32f4xx_hal::pac::{GPIOB, GPIOC};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;

/// The home switches and the emergency stop.
pub type Switches = Inputs<
    PC4<Input>,
    PC5<Input>,
    Level<false>,
    Level<false>,
    PB12<Input>,
    Level<true>,
    Level<true>,
>;

/// In the place of an input that the drives do not have, because they tell over the bus what it would: an index output without a pulse,
/// a fault output without a fault.
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

/// The pins by their function.
pub struct Pins {
    /// The bus: in, out.
    pub bus: (PB8<Alternate<9>>, PB9<Alternate<9>>),
    /// Releases the brake when high; low.
    pub brake: PC6<Output>,
    /// Home switches and emergency stop.
    pub switches: Switches,
    /// The tool's output, floating.
    pub tool: PC7<Input>,
    /// The serial line: out, in.
    pub serial: (PB6<Alternate<7>>, PB7<Alternate<7>>),
}

impl Pins {
    /// Gives each pin its function.
    pub fn new(b: GPIOB, c: GPIOC, rcc: &mut Rcc) -> Self {
        let (b, c) = (b.split(rcc), c.split(rcc));
        Self {
            bus: (pulled_up(b.pb8.into_alternate()), b.pb9.into_alternate()),
            brake: c.pc6.into_push_pull_output(),
            switches: Inputs {
                home1: c.pc4.into_pull_up_input(),
                home4: c.pc5.into_pull_up_input(),
                index1: Level,
                index4: Level,
                emergency_stop: b.pb12.into_pull_up_input(),
                fault1: Level,
                fault4: Level,
            },
            tool: c.pc7,
            serial: (b.pb6.into_alternate(), pulled_up(b.pb7.into_alternate())),
        }
    }
}

/// The pin with the chip's pull-up.
fn pulled_up<Pin: PinPull>(pin: Pin) -> Pin {
    pin.internal_resistor(Pull::Up)
}
