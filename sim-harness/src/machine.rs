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
    /// The image for a board with motors.
    pub board: &'static str,
    /// The image for an emulated board.
    pub emulated: &'static str,
    /// What limits the torques at its joints, in words.
    pub torque_limit: &'static str,
    /// What its status tells of the drives. The rest is 0.
    pub shows: &'static [Signal],
    boards: [Board; 2],
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
            board: "stm32f405_stepper",
            emulated: StepDrives::IMAGE,
            torque_limit: "torque at which steps are lost",
            shows: &[],
            boards: [Board::Stm32f405Stepper, StepDrives::BOARD],
        };
        match kind {
            DriveKind::Brushed => Self {
                motors: "brushed motors",
                board: "stm32f405",
                emulated: BrushedDrives::IMAGE,
                torque_limit: "peak torque of the motor",
                shows: &[Signal::Torque, Signal::Current, Signal::BusVoltage],
                boards: [Board::Stm32f405, BrushedDrives::BOARD],
            },
            DriveKind::Stepper => steps,
            DriveKind::CanTorque => Self {
                motors: "drives on a CAN bus",
                board: "stm32f405_can",
                emulated: BusDrives::IMAGE,
                torque_limit: "peak torque of the drive",
                shows: &[Signal::Torque, Signal::Current],
                boards: [Board::Stm32f405Can, BusDrives::BOARD],
            },
            // Their controller is that of steppers; on an emulated board it is the same image.
            DriveKind::Servo => Self {
                motors: "hobby servos",
                board: "rp2350_servo",
                torque_limit: "stall torque (a servo turns to each pulse with all that it has)",
                boards: [Board::Rp2350Servo, StepDrives::BOARD],
                ..steps
            },
        }
    }

    /// Whether a controller on this board drives it.
    pub fn fits(&self, board: Board) -> bool {
        board == Board::Desktop || self.boards.contains(&board)
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
            for board in machine.boards {
                assert_eq!(motors_of(board), machine.motors);
                let fitting = machines.iter().filter(|other| other.fits(board));
                assert_eq!(fitting.count(), 1, "{board:?}");
            }
            assert!(!machine.fits(Board::Rp2350Servo), "{}", machine.motors);
        }
        let servos = Machine::of(DriveKind::Servo);
        assert_eq!(motors_of(Board::Rp2350Servo), servos.motors);
        assert!(servos.fits(Board::Rp2350Servo) && !servos.fits(Board::Stm32f405Stepper));
    }
}
