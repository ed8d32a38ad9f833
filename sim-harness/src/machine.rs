//! What a machine is by the kind of its drives: its name in messages, the images of the firmware for it, and what it shows.
//! Pages, senders and commands ask this and nothing else of a kind.

use crate::boards::{BoardImage, IMAGES};
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
    drives: DriveKind,
    /// The image for an emulated board.
    pub emulated: &'static str,
    /// What limits the torques at its joints, in words.
    pub torque_limit: &'static str,
    /// What its status tells of the drives. The rest is 0.
    pub shows: &'static [Signal],
    emulated_board: Board,
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
            drives: DriveKind::Stepper,
            emulated: StepDrives::IMAGE,
            torque_limit: "torque at which steps are lost",
            shows: &[],
            emulated_board: StepDrives::BOARD,
        };
        match kind {
            DriveKind::Brushed => Self {
                motors: "brushed motors",
                drives: DriveKind::Brushed,
                emulated: BrushedDrives::IMAGE,
                torque_limit: "peak torque of the motor",
                shows: &[Signal::Torque, Signal::Current, Signal::BusVoltage],
                emulated_board: BrushedDrives::BOARD,
            },
            DriveKind::Stepper => steps,
            DriveKind::CanTorque => Self {
                motors: "drives on a CAN bus",
                drives: DriveKind::CanTorque,
                emulated: BusDrives::IMAGE,
                torque_limit: "peak torque of the drive",
                shows: &[Signal::Torque, Signal::Current],
                emulated_board: BusDrives::BOARD,
            },
            // Their controller is that of steppers; on an emulated board it is the same image.
            DriveKind::Servo => Self {
                motors: "hobby servos",
                drives: DriveKind::Servo,
                torque_limit: "stall torque (a servo turns to each pulse with all that it has)",
                ..steps
            },
        }
    }

    /// The images for boards with motors; the first one is for the usual board.
    pub fn images(self) -> impl Iterator<Item = BoardImage> {
        let drives = self.drives;
        IMAGES
            .into_iter()
            .filter(move |image| image.drives == drives)
    }

    /// Whether a controller on this board drives it.
    pub fn fits(&self, board: Board) -> bool {
        let has_image = self.images().any(|image| image.board == board);
        board == Board::Desktop || board == self.emulated_board || has_image
    }

    /// What to do about a controller that does not fit.
    pub fn image_to_write(&self) -> String {
        let names: Vec<_> = self.images().map(|image| image.name).collect();
        format!("write the image `{}` to the board", names.join("` or `"))
    }
}

#[cfg(test)]
mod tests {
    use super::{Board, DriveKind, IMAGES, Machine};
    use crate::link::motors_of;

    #[test]
    fn a_machine_fits_the_boards_that_have_its_images_and_no_other() {
        let emulated = [DriveKind::Brushed, DriveKind::Stepper, DriveKind::CanTorque];
        let machines = emulated.map(Machine::of);
        for machine in machines {
            let board = machine.emulated_board;
            assert_eq!(motors_of(board), machine.motors);
            let fitting = machines.iter().filter(|other| other.fits(board));
            assert_eq!(fitting.count(), 1, "{board:?}");
        }
        let machines = IMAGES.map(|image| Machine::of(image.drives));
        for (image, own) in IMAGES.into_iter().zip(machines) {
            assert_eq!(motors_of(image.board), own.motors);
            for machine in machines {
                assert_eq!(machine.fits(image.board), machine == own, "{}", image.name);
            }
        }
        assert!(Machine::of(DriveKind::Brushed).fits(Board::Desktop));
    }

    #[test]
    fn a_machine_names_all_of_its_images_the_usual_one_first() {
        let steppers = Machine::of(DriveKind::Stepper);
        let [first, second] = [0, 1].map(|index| steppers.images().nth(index).expect("two").name);
        assert_eq!(
            steppers.image_to_write(),
            format!("write the image `{first}` or `{second}` to the board")
        );
        assert_eq!(first, "stm32f405_stepper");
    }
}
