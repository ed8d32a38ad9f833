//! The kinds of drives that controllers in this process are compiled for, and that an emulated board has an image for.

use super::Emulator;
use super::in_process::{self, Called};
use super::loopback::{self, Desk, Plant};
use crate::boards::Facts;
use fivebar_firmware::Settings;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::drives::{BrushedDrives, DriveInterface, StepDrives};
use fivebar_firmware::protocol::Board;
use fivebar_firmware::settings::SettingsError;
use std::path::PathBuf;

/// Drives whose controller is compiled in this crate. It is optimised also in the dev profile; a program or a test that is
/// not would compile the controller once more, and run it many times as slowly.
pub trait DesktopDrives: DriveInterface + Sized {
    /// A board with these settings, as after a reset, in lockstep with the host or with a clock of its own that moves
    /// `plant`.
    ///
    /// # Errors
    /// The first setting that is not valid.
    fn desk(
        settings: &Settings,
        plant: Option<Plant<Self>>,
    ) -> Result<Box<dyn Desk>, SettingsError>;

    /// A controller without a connection, as after a reset.
    ///
    /// # Errors
    /// The first setting that is not valid.
    fn called(settings: &Settings) -> Result<Box<dyn Called<Self>>, SettingsError>;
}

macro_rules! compiled {
    ($($drives:ty),*) => {$(
        impl DesktopDrives for $drives {
            fn desk(
                settings: &Settings,
                plant: Option<Plant<Self>>,
            ) -> Result<Box<dyn Desk>, SettingsError> {
                loopback::desk::<Self>(settings, plant)
            }

            fn called(settings: &Settings) -> Result<Box<dyn Called<Self>>, SettingsError> {
                in_process::called::<Self>(settings)
            }
        }
    )*};
}
compiled!(BrushedDrives, StepDrives, BusDrives);

/// Drives whose wires are frames on an emulated board.
pub trait EmulatedDrives: DesktopDrives {
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
    Facts::of(board).motors
}
