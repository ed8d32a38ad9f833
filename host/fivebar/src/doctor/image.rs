//! Checks of the firmware's images.

use super::State;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::controller::Request;
use fivebar_sim::boards::BoardImage;
use fivebar_sim::link::{EmulatedDrives, Emulator, EmulatorError, Lockstep, Target};
use fivebar_sim::simulation::{SimulatedArm, SimulatedDrives};
use std::error::Error;
use std::path::Path;

/// Ticks of homing that are compared with this program's.
const TICKS: usize = 200;

/// Whether an image exists at the place where its script builds it.
pub(super) fn state(image: &BoardImage) -> State {
    state_at(&image.built(), image.chip.script)
}

fn state_at(path: &Path, builder: &str) -> State {
    match path.canonicalize() {
        Ok(found) => State::Found(found.display().to_string()),
        Err(_) => State::Missing(format!(
            "{builder} builds it; looked for {}",
            path.display()
        )),
    }
}

/// The state of an emulated board's image. It must give the same outputs as this program.
pub(super) fn of_emulated_board<I: EmulatedDrives + SimulatedDrives>(robot: &str) -> State {
    let image = I::built_image();
    let found = state_at(&image, "scripts/firmware.sh");
    if matches!(found, State::Missing(_)) {
        return found;
    }
    match compare_outputs::<I>(&image, robot) {
        Ok(()) => found,
        Err(reason) => State::Outdated(format!("{reason}; {}", Emulator::likely_cause(&image))),
    }
}

/// Compares an emulated board with this image with this program: starts a run of a built-in robot as
/// `fivebar pil` does, and compares all outputs bit by bit.
///
/// # Errors
/// The board does not run, or the first output that differs.
pub fn compare_outputs<I: EmulatedDrives + SimulatedDrives>(
    image: &Path,
    robot: &str,
) -> Result<(), Box<dyn Error>> {
    let board = match Emulator::start(image) {
        // Without an emulator the image cannot be run; another check reports that.
        Err(EmulatorError::NoQemu) => return Ok(()),
        other => other?,
    };
    let robot = Robot::load(robot)?;
    let settings = robot.settings()?;
    let period = 1.0 / robot.control.tick_rate;
    let mut plant = I::arm(&Scenario::demonstration(robot))?;
    let (mut lockstep, _) = Lockstep::<_, I>::begin(board, &settings, &settings)?;
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
    use super::compare_outputs;
    use fivebar_files::robot::BuiltIn;
    use fivebar_firmware::drives::BrushedDrives;
    use std::path::Path;

    #[test]
    fn a_missing_image_does_not_pass_the_check() {
        let error = compare_outputs::<BrushedDrives>(Path::new("/nowhere/qemu"), BuiltIn::DEFAULT)
            .expect_err("no such image");
        assert!(error.to_string().contains("scripts/firmware.sh"), "{error}");
    }
}
