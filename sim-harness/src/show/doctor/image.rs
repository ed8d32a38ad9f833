//! The firmware's images, and whether the emulated board's is this program's.

use super::State;
use crate::input::robot::{BuiltIn, Robot};
use crate::input::scenario::Scenario;
use crate::run::link::{Emulator, EmulatorError, Lockstep, Target};
use fivebar_firmware::controller::Request;
use std::error::Error;
use std::path::Path;

/// Ticks of homing that are held against this program's.
const TICKS: usize = 200;

/// An image, where it was built.
pub(super) fn state(name: &str) -> State {
    let path = Emulator::built_image(name);
    match path.canonicalize() {
        Ok(found) => State::Found(found.display().to_string()),
        Err(_) => State::Missing(format!(
            "scripts/firmware.sh builds it; looked for {}",
            path.display()
        )),
    }
}

/// The emulated board's image, which is of use only if it answers as this program does.
pub(super) fn of_emulated_board() -> State {
    let found = state("qemu");
    let image = Emulator::built_image("qemu");
    if matches!(found, State::Missing(_)) {
        return found;
    }
    match answers_alike(&image) {
        Ok(()) => found,
        Err(reason) => State::Outdated(format!("{reason}; {}", Emulator::likely_cause(&image))),
    }
}

/// Whether an emulated board with this image answers as this program does: begins a run as
/// `fivebar pil` does, and holds the bits against this program's.
///
/// # Errors
/// What went wrong, or the first bits that differ.
pub fn answers_alike(image: &Path) -> Result<(), Box<dyn Error>> {
    let board = match Emulator::start(image) {
        // Without an emulator there is nobody to ask, and that is told of already.
        Err(EmulatorError::NoQemu) => return Ok(()),
        other => other?,
    };
    let robot = Robot::load(BuiltIn::DEFAULT)?;
    let settings = robot.settings()?;
    let period = 1.0 / robot.control.tick_rate;
    let mut plant = Scenario::demonstration(robot).plant()?;
    let (mut lockstep, _) = Lockstep::begin(board, &settings, &settings)?;
    for tick in 0..TICKS {
        let (command, _) = lockstep.tick(&plant.sense())?;
        plant.step(&command, period);
        if tick == 0 {
            lockstep.request(Request::Home)?;
        }
    }
    match lockstep.first_difference() {
        None => Ok(()),
        Some(difference) => Err(difference.clone().into()),
    }
}

#[cfg(test)]
mod tests {
    use super::answers_alike;
    use std::path::Path;

    #[test]
    fn what_is_no_image_does_not_pass_for_one() {
        let error = answers_alike(Path::new("/nowhere/qemu")).expect_err("no such image");
        assert!(error.to_string().contains("scripts/firmware.sh"), "{error}");
    }
}
