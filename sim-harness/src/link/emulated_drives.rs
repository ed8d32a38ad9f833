//! The kinds of drives that an emulated board has an image for.

use super::Emulator;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::drives::{BrushedDrives, DriveInterface, StepDrives};
use fivebar_firmware::protocol::Board;
use std::path::PathBuf;

/// Drives whose wires are frames on an emulated board.
pub trait EmulatedDrives: DriveInterface {
    /// What the board is.
    const BOARD: Board;
    /// Its image.
    const IMAGE: &'static str;
    /// What goes to the drives.
    const OUTPUTS: &'static str;

    /// Where `scripts/firmware.sh` leaves the image.
    fn built_image() -> PathBuf {
        Emulator::built_image(Self::IMAGE)
    }
}

impl EmulatedDrives for BrushedDrives {
    const BOARD: Board = Board::Emulated;
    const IMAGE: &'static str = "qemu";
    const OUTPUTS: &'static str = "duties";
}

impl EmulatedDrives for StepDrives {
    const BOARD: Board = Board::EmulatedStepper;
    const IMAGE: &'static str = "qemu_stepper";
    const OUTPUTS: &'static str = "micro-steps";
}

impl EmulatedDrives for BusDrives {
    const BOARD: Board = Board::EmulatedCan;
    const IMAGE: &'static str = "qemu_can";
    const OUTPUTS: &'static str = "frames of the bus";
}

/// What a controller on this board drives.
pub fn motors_of(board: Board) -> &'static str {
    match board {
        Board::Desktop | Board::Emulated | Board::Stm32f405 => "brushed motors",
        Board::Stm32f405Stepper | Board::EmulatedStepper => "steppers",
        Board::Stm32f405Can | Board::EmulatedCan => "drives on a CAN bus",
    }
}
