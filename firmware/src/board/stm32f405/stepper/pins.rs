//! The function of each pin with stepper drivers: the table of `docs/use/wiring.md` as types.
//!
//! The enables are low when a driver has power, and each driver has a
//! resistor that pulls its enable high: while the chip is in reset, or its cable is off, the motors have no power.

use crate::board::stm32f405::pins::{CommonPins, Level, pulled_up};
use crate::drivers::Inputs;
use stm32f4xx_hal::gpio::{
    Alternate, Input, Output, PA6, PA8, PA9, PB0, PB1, PB12, PB14, PB15, PC4, PC5, PC8, PC9,
    PinState,
};
use stm32f4xx_hal::pac::{GPIOA, GPIOB, GPIOC};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;

/// The home switches, the emergency stop and both drivers' fault outputs.
pub type Switches = Inputs<
    PC4<Input>,
    PC5<Input>,
    Level<false>,
    Level<false>,
    PB12<Alternate<1>>,
    PB0<Input>,
    PB1<Input>,
>;

/// The pins by their function.
pub struct Pins {
    /// Both drivers.
    pub outputs: OutputPins,
    /// Switches and fault outputs.
    pub switches: Switches,
    /// Those of each image.
    pub common: CommonPins,
}

/// The pins of the outputs.
pub struct OutputPins {
    /// Step 1, step 4, and the second break input: the emergency stop again.
    pub timers: (PA8<Alternate<1>>, PC8<Alternate<3>>, PA6<Alternate<3>>),
    /// Direction of motor 1: high is forwards.
    pub direction1: PA9<Output>,
    /// Direction of motor 4.
    pub direction4: PC9<Output>,
    /// Enable of driver 1: low has power; high.
    pub enable1: PB14<Output>,
    /// Enable of driver 4: low has power; high.
    pub enable4: PB15<Output>,
}

impl Pins {
    /// Gives each pin its function, the enables first: high, no power.
    pub fn new(a: GPIOA, b: GPIOB, c: GPIOC, rcc: &mut Rcc) -> Self {
        let (a, b, c) = (a.split(rcc), b.split(rcc), c.split(rcc));
        Self {
            outputs: OutputPins {
                enable1: b.pb14.into_push_pull_output_in_state(PinState::High),
                enable4: b.pb15.into_push_pull_output_in_state(PinState::High),
                timers: (
                    a.pa8.into_alternate(),
                    c.pc8.into_alternate(),
                    pulled_up(a.pa6.into_alternate()),
                ),
                direction1: a.pa9.into_push_pull_output(),
                direction4: c.pc9.into_push_pull_output(),
            },
            switches: Inputs {
                home1: c.pc4.into_pull_up_input(),
                home4: c.pc5.into_pull_up_input(),
                index1: Level,
                index4: Level,
                emergency_stop: pulled_up(b.pb12.into_alternate()),
                fault1: b.pb0.into_pull_down_input(),
                fault4: b.pb1.into_pull_down_input(),
            },
            common: CommonPins::new((b.pb6, b.pb7), c.pc6, c.pc7),
        }
    }
}
