//! The function of each pin with bridges: the table of `docs/use/wiring.md` as types.

use super::pwm;
use crate::board::stm32f405::pins::{CommonPins, pulled_up};
use crate::drivers::Inputs;
use stm32f4xx_hal::gpio::{
    Alternate, Analog, Input, Output, PA0, PA1, PA15, PB0, PB1, PB3, PB12, PB14, PB15, PC0, PC1,
    PC2, PC4, PC5, PC8, PC9,
};
use stm32f4xx_hal::pac::{GPIOA, GPIOB, GPIOC};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;

/// The home switches, the encoders' index outputs, the emergency stop and both bridges' fault outputs. The emergency
/// stop is on the timer's break pin, which can also be read as an input.
pub type Switches = Inputs<
    PC4<Input>,
    PC5<Input>,
    PC8<Input>,
    PC9<Input>,
    PB12<Alternate<1>>,
    PB0<Input>,
    PB1<Input>,
>;

/// The pins by their function.
pub struct Pins {
    /// Both bridges.
    pub outputs: OutputPins,
    /// Encoder of joint 1: A, B.
    pub encoder1: (PA0<Alternate<2>>, PA1<Alternate<2>>),
    /// Encoder of joint 4: A, B.
    pub encoder4: (PA15<Alternate<1>>, PB3<Alternate<1>>),
    /// Current 1, current 4, bus voltage.
    pub analog: (PC0<Analog>, PC1<Analog>, PC2<Analog>),
    /// Switches and fault outputs.
    pub switches: Switches,
    /// Those of each image.
    pub common: CommonPins,
}

/// The pins of the outputs.
pub struct OutputPins {
    /// IN1 and IN2 of both bridges.
    pub pwm: pwm::Pins,
    /// Bridge 1's sleep input, low.
    pub sleep1: PB14<Output>,
    /// Bridge 4's sleep input, low.
    pub sleep4: PB15<Output>,
}

impl Pins {
    /// Gives each pin its function, the bridges' sleep inputs first: low, asleep.
    pub fn new(a: GPIOA, b: GPIOB, c: GPIOC, rcc: &mut Rcc) -> Self {
        let (a, b, c) = (a.split(rcc), b.split(rcc), c.split(rcc));
        Self {
            outputs: OutputPins {
                sleep1: b.pb14.into_push_pull_output(),
                sleep4: b.pb15.into_push_pull_output(),
                pwm: (
                    a.pa8.into_alternate(),
                    a.pa9.into_alternate(),
                    a.pa10.into_alternate(),
                    a.pa11.into_alternate(),
                ),
            },
            encoder1: (
                pulled_up(a.pa0.into_alternate()),
                pulled_up(a.pa1.into_alternate()),
            ),
            encoder4: (
                pulled_up(a.pa15.into_alternate()),
                pulled_up(b.pb3.into_alternate()),
            ),
            analog: (
                c.pc0.into_analog(),
                c.pc1.into_analog(),
                c.pc2.into_analog(),
            ),
            switches: Inputs {
                home1: c.pc4.into_pull_up_input(),
                home4: c.pc5.into_pull_up_input(),
                index1: c.pc8.into_pull_up_input(),
                index4: c.pc9.into_pull_up_input(),
                emergency_stop: pulled_up(b.pb12.into_alternate()),
                fault1: b.pb0.into_pull_down_input(),
                fault4: b.pb1.into_pull_down_input(),
            },
            common: CommonPins::new((b.pb6, b.pb7), c.pc6, c.pc7),
        }
    }
}
