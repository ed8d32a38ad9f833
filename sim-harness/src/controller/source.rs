//! The controller that is chosen: simulated, emulated, or on a port.

use super::Hand;
use super::session::Session;
use super::simulated;
use crate::boards::{Facts, Ticks};
use crate::clock::Clock;
use crate::drive::{Drive, DriveError};
use crate::link::{Client, Emulator, EmulatorError, LinkError, PortError, SerialLine, motors_of};
use crate::machine::Machine;
use crate::simulation::RunError;
use fivebar_files::robot::Robot;
use fivebar_firmware::protocol::CommandError;
use fivebar_firmware::settings::SettingsError;
use std::io::{Read, Write};
use std::path::Path;

/// Where the controller runs.
#[derive(Clone, Copy, Debug)]
pub enum ControllerSource<'a> {
    /// A controller in this process with the simulated arm, whose time is the clock's.
    Simulated,
    /// The same with a hand that leads the arm's tip.
    Led(&'a Hand),
    /// This firmware image on an emulated board, with the simulated arm.
    Emulated(&'a Path),
    /// A controller on a serial port with its own arm. A board with the image `qemu` gets
    /// the simulated arm.
    Port {
        /// The port's name.
        name: &'a str,
        /// Whether to store the robot's settings on the controller.
        upload: bool,
    },
}

/// Why the controller cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpenError {
    /// The robot cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] RunError),
    /// The port cannot be opened.
    #[error(transparent)]
    Port(#[from] PortError),
    /// The emulated board does not run.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The controller has settings for another arm, or refuses the robot's.
    #[error(transparent)]
    OtherArm(#[from] DriveError),
    /// The emulated board refuses the robot's settings.
    #[error("the emulated board refuses the robot's settings: {0}")]
    Refused(CommandError),
    /// The controller is for motors of another kind, these.
    #[error("the controller is for {controller} and the robot has {robot}; {instead}")]
    ForOthers {
        /// What the controller drives.
        controller: &'static str,
        /// What the robot has.
        robot: &'static str,
        /// The way out.
        instead: String,
    },
    /// The controller does not reply.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The controller's settings are not valid.
    #[error("the controller's settings: {0}")]
    Settings(#[from] SettingsError),
}

/// A stream of bytes to a controller.
pub trait Connection: Read + Write + Send {}
impl<L: Read + Write + Send> Connection for L {}

/// Opens the controller and makes sure that it has the robot's settings. Returns the session with it,
/// which keeps the time of `clock`, and where it runs.
///
/// # Errors
/// The port cannot be opened, the robot cannot be simulated, or the controller has settings for
/// another arm or does not reply.
pub fn open(
    robot: &Robot,
    source: ControllerSource<'_>,
    clock: &Clock,
) -> Result<(Session, String), OpenError> {
    let machine = Machine::of(robot.drive_kind());
    let line: Box<dyn Connection> = match source {
        ControllerSource::Simulated => simulated::line(robot, clock, None)?,
        ControllerSource::Led(hand) => simulated::line(robot, clock, Some(hand.clone()))?,
        ControllerSource::Emulated(image) => Box::new(Emulator::start(image)?),
        ControllerSource::Port { name, .. } => Box::new(SerialLine::open(name)?),
    };
    let (mut client, identity) = Client::open(line)?;
    if !machine.fits(identity.board) {
        return Err(OpenError::ForOthers {
            controller: motors_of(identity.board),
            robot: machine.motors,
            instead: machine.image_to_write(),
        });
    }
    let settings = robot.settings().map_err(RunError::from)?.check()?;
    let (place, stepped) = match Facts::of(identity.board).ticks {
        Ticks::Host => {
            let answer = client.write_settings(&settings)?;
            answer.map_err(OpenError::Refused)?;
            (
                "emulated controller, simulated arm",
                Some(simulated::stepped(robot, clock)?),
            )
        }
        Ticks::Own | Ticks::Either => {
            let mut drive = Drive::new(&mut client, &|| false);
            match source {
                ControllerSource::Port { upload: true, .. } => drive.store_settings(&settings)?,
                _ => drive.compare_settings(&settings)?,
            }
            match source {
                ControllerSource::Port { name, .. } => (name, None),
                ControllerSource::Simulated
                | ControllerSource::Led(_)
                | ControllerSource::Emulated(_) => ("simulated", None),
            }
        }
    };
    let session = Session::new(client, stepped, settings, clock.clone())?;
    Ok((session, place.into()))
}
