//! What a machine is by the kind of its drives: its name in messages, the images of the firmware for it, and what it shows.
//! Pages, senders and commands ask this and nothing else of a kind.

use crate::link::EmulatedDrives;
use fivebar_files::robot::DriveKind;
use fivebar_firmware::drives::can::BusDrives;
use fivebar_firmware::drives::{BrushedDrives, StepDrives};
use fivebar_firmware::protocol::Board;
use serde::Serialize;

/// A machine by the kind of its drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    /// What turns the joints.
    pub motors: &'static str,
    /// The images for boards with motors; the first one is for the usual board.
    pub images: &'static [BoardImage],
    /// The image for an emulated board.
    pub emulated: &'static str,
    /// What limits the torques at its joints, in words.
    pub torque_limit: &'static str,
    /// What its status tells of the drives. The rest is 0.
    pub shows: &'static [Signal],
    emulated_board: Board,
}

/// An image for a board with motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardImage {
    /// What the file is called.
    pub name: &'static str,
    /// What its users call the board.
    pub chip: &'static str,
    /// What it says of itself.
    pub board: Board,
}

impl BoardImage {
    const fn stm32f405(name: &'static str, board: Board) -> Self {
        let chip = "stm32f405";
        Self { name, chip, board }
    }

    const fn pico2(name: &'static str, board: Board) -> Self {
        let chip = "pico2";
        Self { name, chip, board }
    }
}

/// What a status tells of drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Signal {
    /// The demanded torques at the joints [N·m].
    Torque,
    /// The motors' measured currents [A].
    Current,
    /// The voltage of the supply [V].
    BusVoltage,
}

impl Machine {
    /// The machine with this kind of drives.
    pub fn of(kind: DriveKind) -> Self {
        let steps = Self {
            motors: "steppers",
            images: const {
                &[
                    BoardImage::stm32f405("stm32f405_stepper", Board::Stm32f405Stepper),
                    BoardImage::pico2("rp2350_stepper", Board::Rp2350Stepper),
                ]
            },
            emulated: StepDrives::IMAGE,
            torque_limit: "torque at which steps are lost",
            shows: &[],
            emulated_board: StepDrives::BOARD,
        };
        match kind {
            DriveKind::Brushed => Self {
                motors: "brushed motors",
                images: const { &[BoardImage::stm32f405("stm32f405", Board::Stm32f405)] },
                emulated: BrushedDrives::IMAGE,
                torque_limit: "peak torque of the motor",
                shows: &[Signal::Torque, Signal::Current, Signal::BusVoltage],
                emulated_board: BrushedDrives::BOARD,
            },
            DriveKind::Stepper => steps,
            DriveKind::CanTorque => Self {
                motors: "drives on a CAN bus",
                images: const { &[BoardImage::stm32f405("stm32f405_can", Board::Stm32f405Can)] },
                emulated: BusDrives::IMAGE,
                torque_limit: "peak torque of the drive",
                shows: &[Signal::Torque, Signal::Current],
                emulated_board: BusDrives::BOARD,
            },
            // Their controller is that of steppers; on an emulated board it is the same image.
            DriveKind::Servo => Self {
                motors: "hobby servos",
                images: const { &[BoardImage::pico2("rp2350_servo", Board::Rp2350Servo)] },
                torque_limit: "stall torque (a servo turns to each pulse with all that it has)",
                ..steps
            },
        }
    }

    /// Whether a controller on this board drives it.
    pub fn fits(&self, board: Board) -> bool {
        let has_image = self.images.iter().any(|image| image.board == board);
        board == Board::Desktop || board == self.emulated_board || has_image
    }

    /// What to do about a controller that does not fit.
    pub fn image_to_write(&self) -> String {
        let names: Vec<_> = self.images.iter().map(|image| image.name).collect();
        format!("write the image `{}` to the board", names.join("` or `"))
    }
}

#[cfg(test)]
mod tests {
    use super::{Board, DriveKind, Machine};
    use crate::link::motors_of;

    #[test]
    fn a_machine_fits_the_boards_that_have_its_images_and_no_other() {
        let kinds = [DriveKind::Brushed, DriveKind::Stepper, DriveKind::CanTorque];
        let machines = kinds.map(Machine::of);
        for machine in machines {
            let boards = machine.images.iter().map(|image| image.board);
            for board in boards.chain([machine.emulated_board]) {
                assert_eq!(motors_of(board), machine.motors);
                let fitting = machines.iter().filter(|other| other.fits(board));
                assert_eq!(fitting.count(), 1, "{board:?}");
            }
            assert!(!machine.fits(Board::Rp2350Servo), "{}", machine.motors);
        }
        let servos = Machine::of(DriveKind::Servo);
        assert_eq!(motors_of(Board::Rp2350Servo), servos.motors);
        assert!(servos.fits(Board::Rp2350Servo) && !servos.fits(Board::Stm32f405Stepper));
        let steppers = Machine::of(DriveKind::Stepper);
        assert!(steppers.fits(Board::Rp2350Stepper) && !servos.fits(Board::Rp2350Stepper));
        assert_eq!(
            steppers.image_to_write(),
            "write the image `stm32f405_stepper` or `rp2350_stepper` to the board"
        );
    }
}
