//! The identity of a controller: its reply to a hello.

use super::VERSION;
use serde::{Deserialize, Serialize};

/// The identity of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Identity {
    /// The controller's [`VERSION`].
    pub version: u16,
    /// The board that it runs on.
    pub board: Board,
    /// The firmware's version: major, minor, patch.
    pub firmware: [u8; 3],
    /// Why it started.
    pub reset: Reset,
}

/// What a controller runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Board {
    /// In the host's own process.
    Desktop,
    /// An emulated Cortex-M4F for brushed motors: sensors and bridges are frames.
    Emulated,
    /// An STM32F405 that drives brushed motors.
    Stm32f405,
    /// An STM32F405 that gives stepper drivers their steps.
    Stm32f405Stepper,
    /// An STM32F405 with torque drives on its CAN bus.
    Stm32f405Can,
    /// An emulated Cortex-M4F for steppers: micro-steps are frames.
    EmulatedStepper,
    /// An emulated Cortex-M4F for torque drives on a CAN bus: those of the bus are in frames.
    EmulatedCan,
    /// An RP2350 that makes the pulses of hobby servos.
    Rp2350Servo,
    /// An RP2350 that gives stepper drivers their steps.
    Rp2350Stepper,
}

/// Why a controller started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reset {
    /// Power came on.
    Power,
    /// A debugger or the program itself reset it.
    Software,
    /// The watchdog was not refreshed in time.
    Watchdog,
    /// The program panicked.
    Panic,
    /// The processor raised a hard fault: an invalid instruction or address.
    HardFault,
    /// The supply voltage was too low.
    BrownOut,
    /// The reset pin was pulled.
    Pin,
    /// None of these: no flag says why, or that of a low-power mode, which no program here enters.
    Unknown,
}

impl Identity {
    /// A controller of this library's version.
    pub const fn new(board: Board, reset: Reset) -> Self {
        Self {
            version: VERSION,
            board,
            firmware: FIRMWARE,
            reset,
        }
    }
}

/// This library's version: major, minor, patch.
const FIRMWARE: [u8; 3] = [
    number(env!("CARGO_PKG_VERSION_MAJOR")),
    number(env!("CARGO_PKG_VERSION_MINOR")),
    number(env!("CARGO_PKG_VERSION_PATCH")),
];

/// The number that the digits stand for.
const fn number(digits: &str) -> u8 {
    match u8::from_str_radix(digits, 10) {
        Ok(number) => number,
        Err(_) => panic!("a part of the version is not below 256"),
    }
}
