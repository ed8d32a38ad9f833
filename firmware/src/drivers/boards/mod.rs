//! Boards with an STM32F405 or F407 of 1 MiB of flash, as data: the pin of each signal, the crystal, and the kinds of
//! drive that a board's headers have no pins for.
//!
//! An image is built for one of them: `FIVEBAR_BOARD=NAME`, or the first one. The compiler refuses a board whose signals
//! share a pin, or of which one is at a pin where its peripheral does not have it.

mod check;
mod pins;
mod places;

pub use pins::{BrushedPins, CanPins, CommonPins, Row, StepperPins, Use};
pub use places::{Peripheral, Pin, analog};

/// A board.
#[derive(Clone, Copy, Debug)]
pub struct Board {
    /// Its name.
    pub name: &'static str,
    /// What is sold as it.
    pub what: &'static str,
    /// Its crystal [MHz]: one that is told by measurement.
    pub crystal: u32,
    /// The pins of every image.
    pub common: CommonPins,
    /// Those for brushed motors, or why it has none.
    pub brushed: Result<BrushedPins, &'static str>,
    /// Those for steppers, or why it has none.
    pub stepper: Result<StepperPins, &'static str>,
    /// Those for drives on a CAN bus, or why it has none.
    pub can: Result<CanPins, &'static str>,
}

const fn p(port: u8, number: u8) -> Pin {
    Pin::new(port, number)
}

const COMMON: CommonPins = CommonPins {
    brake: p(b'C', 6),
    tool: p(b'C', 7),
    serial: [p(b'B', 6), p(b'B', 7)],
    home: [p(b'C', 4), p(b'C', 5)],
    stop: p(b'B', 12),
};
const BRUSHED: BrushedPins = BrushedPins {
    bridges: [p(b'A', 8), p(b'A', 9), p(b'A', 10), p(b'A', 11)],
    sleep: [p(b'B', 14), p(b'B', 15)],
    fault: [p(b'B', 0), p(b'B', 1)],
    encoder1: [p(b'A', 0), p(b'A', 1)],
    encoder4: [p(b'A', 15), p(b'B', 3)],
    index: [p(b'C', 8), p(b'C', 9)],
};
const STEPPER: StepperPins = StepperPins {
    step: [p(b'A', 8), p(b'C', 8)],
    direction: [p(b'A', 9), p(b'C', 9)],
    enable: [p(b'B', 14), p(b'B', 15)],
    fault: [p(b'B', 0), p(b'B', 1)],
    stop4: p(b'A', 6),
};
const CAN: CanPins = CanPins {
    bus: [p(b'B', 8), p(b'B', 9)],
};

/// The chip with its pins as in `docs/use/wiring.md`.
pub const REFERENCE: Board = Board {
    name: "stm32f405rg",
    what: "any board with an STM32F405RG that has these pins at its headers",
    crystal: 8,
    common: COMMON,
    brushed: Ok(BRUSHED),
    stepper: Ok(STEPPER),
    can: Ok(CAN),
};

/// The boards, the first of them that of an image which is built for no other.
pub const BOARDS: [Board; 6] = [
    REFERENCE,
    Board {
        name: "weact_f405",
        what: "WeAct Studio STM32F405RGT6 core board V1.1: all pins are at its headers; leave its card slot empty, which uses PA8 and PC8 to PC12",
        ..REFERENCE
    },
    Board {
        name: "feather_f405",
        what: "Adafruit Feather STM32F405 Express (4382): PB12 is not at its edge, so the emergency stop is at PC3",
        crystal: 12,
        common: CommonPins {
            stop: p(b'C', 3),
            ..COMMON
        },
        brushed: Err("PA8 to PA11, the channels of TIM1, are not at its edge"),
        stepper: Err("PA8 and PC8, the channels of the steps, are not at its edge"),
        ..REFERENCE
    },
    Board {
        name: "mcustm32f405",
        what: "MCUSTM32F405 of STM32World: compare its headers, which nobody has done; its SPI3 uses PA15 and PC10 to PC12",
        crystal: 16,
        ..REFERENCE
    },
    Board {
        name: "stm32f407vg",
        what: "any board with an STM32F407VG: port E leaves PA9 to PA12 to USB",
        common: CommonPins {
            stop: p(b'E', 15),
            ..COMMON
        },
        brushed: Ok(BrushedPins {
            bridges: [p(b'E', 9), p(b'E', 11), p(b'E', 13), p(b'E', 14)],
            ..BRUSHED
        }),
        stepper: Ok(StepperPins {
            step: [p(b'E', 9), p(b'C', 8)],
            direction: [p(b'E', 11), p(b'C', 9)],
            ..STEPPER
        }),
        can: Ok(CanPins {
            bus: [p(b'D', 0), p(b'D', 1)],
        }),
        ..REFERENCE
    },
    Board {
        name: "stm32f407ig",
        what: "any board with an STM32F407IG: compare its headers and crystal; PH11 of RoboMaster's board C has an LED, so only CAN is for it",
        crystal: 12,
        common: CommonPins {
            serial: [p(b'A', 9), p(b'B', 7)],
            stop: p(b'E', 15),
            ..COMMON
        },
        brushed: Ok(BrushedPins {
            bridges: [p(b'E', 9), p(b'E', 11), p(b'E', 13), p(b'E', 14)],
            encoder1: [p(b'H', 10), p(b'H', 11)],
            ..BRUSHED
        }),
        stepper: Ok(StepperPins {
            step: [p(b'E', 9), p(b'I', 7)],
            direction: [p(b'E', 11), p(b'I', 6)],
            stop4: p(b'I', 4),
            ..STEPPER
        }),
        can: Ok(CanPins {
            bus: [p(b'D', 0), p(b'D', 1)],
        }),
    },
];

/// The board that this image is built for.
pub const BUILT: Board = match option_env!("FIVEBAR_BOARD") {
    None => REFERENCE,
    Some(name) => match Board::named(name) {
        Some(board) => board,
        None => panic!("FIVEBAR_BOARD is none of the names in firmware/src/drivers/boards/mod.rs"),
    },
};

impl Board {
    /// The board of this name.
    pub const fn named(name: &str) -> Option<Self> {
        let mut board = 0;
        while board < BOARDS.len() {
            if check::is_same(BOARDS[board].name, name) {
                return Some(BOARDS[board]);
            }
            board += 1;
        }
        None
    }

    /// The pins for brushed motors; of the first board where this one has none, for code that no image of it has.
    pub const fn brushed(&self) -> BrushedPins {
        match self.brushed {
            Ok(pins) => pins,
            Err(_) => BRUSHED,
        }
    }

    /// The pins for steppers, in the same way.
    pub const fn stepper(&self) -> StepperPins {
        match self.stepper {
            Ok(pins) => pins,
            Err(_) => STEPPER,
        }
    }

    /// The pins for drives on a CAN bus, in the same way.
    pub const fn can(&self) -> CanPins {
        match self.can {
            Ok(pins) => pins,
            Err(_) => CAN,
        }
    }

    /// How the emergency stop uses its pin in images with a timer that it breaks.
    pub const BREAK: Use = Use::Of(Peripheral::Tim1Break);
}
