//! The controller that is chosen: simulated, emulated, or on a port.

use super::simulated;
pub(in crate::show) use super::simulated::SteppedArm;
use super::{ControllerSource, ServeError};
use crate::input::robot::Robot;
use crate::run::drive::Drive;
use crate::run::link::{Client, Emulator, SerialLine};
use crate::run::simulation::RunError;
use fivebar_firmware::protocol::Board;
use fivebar_firmware::settings::CheckedSettings;
use std::io::{Read, Write};

/// A stream of bytes to a controller.
pub(in crate::show) trait Connection: Read + Write + Send {}
impl<L: Read + Write + Send> Connection for L {}

/// A controller with the settings of the robot.
pub(in crate::show) struct Opened {
    pub(in crate::show) client: Client<Box<dyn Connection>>,
    /// The simulated arm of a board in lockstep.
    pub(in crate::show) stepped: Option<SteppedArm>,
    pub(in crate::show) settings: CheckedSettings,
    /// Where the controller runs.
    pub(in crate::show) place: String,
}

/// Opens the controller and makes sure that it has the robot's settings.
///
/// # Errors
/// The port cannot be opened, the robot cannot be simulated, or the controller has settings for
/// another arm or does not reply.
pub(in crate::show) fn open(
    robot: &Robot,
    source: ControllerSource<'_>,
) -> Result<Opened, ServeError> {
    let line: Box<dyn Connection> = match source {
        ControllerSource::Simulated => Box::new(simulated::line(robot)?),
        ControllerSource::Emulated(image) => Box::new(Emulator::start(image)?),
        ControllerSource::Port { name, .. } => Box::new(SerialLine::open(name)?),
    };
    let (mut client, identity) = Client::open(line)?;
    let settings = robot.settings().map_err(RunError::from)?.check()?;
    let (place, stepped) = match identity.board {
        Board::Emulated => {
            let answer = client.write_settings(&settings)?;
            answer.map_err(ServeError::Refused)?;
            (
                "emulated controller, simulated arm",
                Some(SteppedArm::new(robot)?),
            )
        }
        Board::Desktop | Board::Stm32f405 => {
            let upload = matches!(source, ControllerSource::Port { upload: true, .. });
            Drive::new(&mut client, &|| false).agree_on(&settings, upload)?;
            match source {
                ControllerSource::Port { name, .. } => (name, None),
                ControllerSource::Simulated | ControllerSource::Emulated(_) => ("simulated", None),
            }
        }
    };
    Ok(Opened {
        client,
        stepped,
        settings,
        place: place.into(),
    })
}
