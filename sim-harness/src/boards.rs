//! What a host knows of each board: what it is called, what its controller drives, whose clock gives its ticks, and its image. This
//! is the one table: pages and commands ask it and name no board.

use fivebar_files::robot::DriveKind;
use fivebar_firmware::protocol::Board;
use std::path::{Path, PathBuf};

/// What a machine is called by the kind of its drives.
pub(crate) type Drives = (DriveKind, &'static str);

pub(crate) const BRUSHED: Drives = (DriveKind::Brushed, "brushed motors");
pub(crate) const STEPPERS: Drives = (DriveKind::Stepper, "steppers");
pub(crate) const ON_A_BUS: Drives = (DriveKind::CanTorque, "drives on a CAN bus");
pub(crate) const SERVOS: Drives = (DriveKind::Servo, "hobby servos");

/// Where cargo built this program, and scripts/firmware.sh the images.
const BUILT: &str = match option_env!("CARGO_TARGET_DIR") {
    Some(folder) => folder,
    None => concat!(env!("CARGO_MANIFEST_DIR"), "/../target"),
};

/// A board.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// What messages call it.
    name: &'static str,
    /// What its controller drives; none if it is compiled for whatever this program asks for.
    pub drives: Option<DriveKind>,
    /// The same in words.
    pub motors: &'static str,
    /// Who gives its ticks.
    pub ticks: Ticks,
}

/// Who gives a board's ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ticks {
    /// The board.
    Own,
    /// The host, in lockstep.
    Host,
    /// Either of both, as the host chooses.
    Either,
}

/// An image for a board with motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardImage {
    /// What the file is called.
    pub name: &'static str,
    /// What it says of itself.
    pub board: Board,
    /// The drives.
    pub drives: DriveKind,
    /// What runs it.
    pub chip: Chip,
}

/// What runs images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chip {
    /// What its users call it in answers.
    pub name: &'static str,
    /// What sentences call it.
    pub called: &'static str,
    /// The compiler's name for its core.
    pub target: &'static str,
    /// What builds its images.
    pub script: &'static str,
}

const STM32F405: Chip = Chip {
    name: "stm32f405",
    called: "the microcontroller",
    target: "thumbv7em-none-eabihf",
    script: "scripts/firmware.sh",
};
/// The emulated board has the first one's core and script.
pub(crate) const EMULATED: Chip = STM32F405;
const PICO_2: Chip = Chip {
    name: "pico2",
    called: "a Pico 2",
    target: "thumbv8m.main-none-eabihf",
    script: "scripts/pico.sh image",
};

/// The images; of those for the same drives, the usual one first.
pub const IMAGES: [BoardImage; 5] = [
    image("stm32f405", Board::Stm32f405, DriveKind::Brushed, STM32F405),
    image(
        "stm32f405_stepper",
        Board::Stm32f405Stepper,
        DriveKind::Stepper,
        STM32F405,
    ),
    image(
        "stm32f405_can",
        Board::Stm32f405Can,
        DriveKind::CanTorque,
        STM32F405,
    ),
    image("rp2350_servo", Board::Rp2350Servo, DriveKind::Servo, PICO_2),
    image(
        "rp2350_stepper",
        Board::Rp2350Stepper,
        DriveKind::Stepper,
        PICO_2,
    ),
];

const fn image(name: &'static str, board: Board, drives: DriveKind, chip: Chip) -> BoardImage {
    BoardImage {
        name,
        board,
        drives,
        chip,
    }
}

impl Chip {
    /// The path at which its script leaves an image.
    pub(crate) fn built(&self, name: &str) -> PathBuf {
        let folder = Path::new(BUILT).join("firmware").join(self.target);
        folder.join("firmware").join(name)
    }
}

impl BoardImage {
    /// The path at which its script leaves it.
    pub fn built(&self) -> PathBuf {
        self.chip.built(self.name)
    }
}

impl Facts {
    /// Of this board.
    pub const fn of(board: Board) -> Self {
        match board {
            Board::Desktop => Self {
                name: "a controller in a process on a desktop",
                drives: None,
                motors: "any motors",
                ticks: Ticks::Either,
            },
            Board::Emulated => Self::emulated(BRUSHED),
            Board::EmulatedStepper => Self::emulated(STEPPERS),
            Board::EmulatedCan => Self::emulated(ON_A_BUS),
            Board::Stm32f405 => Self::with_motors("an STM32F405", BRUSHED),
            Board::Stm32f405Stepper => Self::with_motors("an STM32F405", STEPPERS),
            Board::Stm32f405Can => Self::with_motors("an STM32F405", ON_A_BUS),
            Board::Rp2350Servo => Self::with_motors("an RP2350", SERVOS),
            Board::Rp2350Stepper => Self::with_motors("an RP2350", STEPPERS),
        }
    }

    const fn emulated((drives, motors): Drives) -> Self {
        Self {
            name: "an emulated board",
            drives: Some(drives),
            motors,
            ticks: Ticks::Host,
        }
    }

    const fn with_motors(name: &'static str, (drives, motors): Drives) -> Self {
        Self {
            name,
            drives: Some(drives),
            motors,
            ticks: Ticks::Own,
        }
    }

    /// What it is, in words.
    pub fn words(&self) -> String {
        match self.drives {
            Some(_) => format!("{} for {}", self.name, self.motors),
            None => self.name.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Facts, IMAGES};

    #[test]
    fn a_board_has_the_drives_of_its_image() {
        for image in IMAGES {
            assert_eq!(Facts::of(image.board).drives, Some(image.drives));
        }
    }

    #[test]
    fn images_are_named_after_their_chip_and_their_drives() {
        for image in IMAGES {
            let same = IMAGES
                .iter()
                .filter(|other| (other.chip.name, other.drives) == (image.chip.name, image.drives));
            assert_eq!(same.count(), 1, "{}", image.name);
        }
    }
}
