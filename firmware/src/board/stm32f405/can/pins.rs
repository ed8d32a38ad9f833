//! The function of each pin with drives on a CAN bus: the table of `docs/use/wiring.md` as types.
//!
//! The drives tell over the bus what an index or a fault output would. Without its transceiver the bus reads recessive, by the
//! pull-up at PB8.

use crate::board::stm32f405::pins::{CommonPins, Level, pulled_up};
use crate::drivers::Inputs;
use stm32f4xx_hal::gpio::{Alternate, Input, PB8, PB9, PB12, PC4, PC5};
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

/// The pins by their function.
pub struct Pins {
    /// The bus: in, out.
    pub bus: (PB8<Alternate<9>>, PB9<Alternate<9>>),
    /// Home switches and emergency stop.
    pub switches: Switches,
    /// Those of each image.
    pub common: CommonPins,
}

impl Pins {
    /// Gives each pin its function.
    pub fn new(b: GPIOB, c: GPIOC, rcc: &mut Rcc) -> Self {
        let (b, c) = (b.split(rcc), c.split(rcc));
        Self {
            bus: (pulled_up(b.pb8.into_alternate()), b.pb9.into_alternate()),
            switches: Inputs {
                home1: c.pc4.into_pull_up_input(),
                home4: c.pc5.into_pull_up_input(),
                index1: Level,
                index4: Level,
                emergency_stop: b.pb12.into_pull_up_input(),
                fault1: Level,
                fault4: Level,
            },
            common: CommonPins::new((b.pb6, b.pb7), c.pc6, c.pc7),
        }
    }
}
