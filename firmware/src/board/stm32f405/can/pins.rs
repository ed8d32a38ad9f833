//! The function of each pin with drives on a CAN bus.
//!
//! The drives tell over the bus what an index or a fault output would. Without its transceiver the bus reads recessive, by the
//! pull-up at its input.

use crate::board::stm32f405::gpio::{self, Resistor};
use crate::board::stm32f405::pins::{self, Home1, Home4, Stop};
use crate::drivers::boards::{BUILT, CanPins, Peripheral};
use crate::drivers::{Inputs, Level};

/// The pins of this board.
pub const PINS: CanPins = BUILT.can();

/// The home switches and the emergency stop.
pub type Switches =
    Inputs<Home1, Home4, Level<false>, Level<false>, Stop, Level<true>, Level<true>>;

/// Gives each pin its function.
pub fn set_up() -> Switches {
    let [receive, send] = PINS.bus;
    gpio::connect(receive, Peripheral::Can1Receive, Resistor::Up);
    gpio::connect(send, Peripheral::Can1Send, Resistor::None);
    let (home1, home4) = pins::home();
    Inputs {
        home1,
        home4,
        index1: Level,
        index4: Level,
        emergency_stop: gpio::input(Resistor::Up),
        fault1: Level,
        fault4: Level,
    }
}
