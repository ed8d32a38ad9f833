//! Where the wires of an arm are at a board: the arms here name them by the pins of the first board.

use crate::peripherals::gpio::Pin;
use fivebar_firmware::drivers::boards::{self, Row};

/// Of each pin of a board the first board's pin with the same wire, if it has a wire.
pub(crate) struct BoardWires([Option<Pin>; 256]);

impl From<boards::Pin> for Pin {
    fn from(pin: boards::Pin) -> Self {
        Self(pin.port(), pin.number())
    }
}

impl BoardWires {
    /// The wires of an arm whose signals have these pins, and these of the first board.
    pub(crate) fn new(rows: &[Row], firsts: &[Row]) -> Self {
        let mut wires = std::array::from_fn(|code| Some(boards::Pin(code as u8).into()));
        for first in firsts {
            wires[usize::from(first.pin.0)] = None;
        }
        for (row, first) in rows.iter().zip(firsts) {
            wires[usize::from(row.pin.0)] = Some(first.pin.into());
        }
        Self(wires)
    }

    /// The first board's pin with the wire that is at this pin.
    pub(crate) fn at(&self, Pin(port, number): Pin) -> Option<Pin> {
        self.0[usize::from(port << 4 | number)]
    }
}
