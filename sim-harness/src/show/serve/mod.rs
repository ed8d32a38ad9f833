//! The live page: an arm in a browser, moved by its controller and by nothing else.
//!
//! A thread of its own, the `Machine`, holds the client with the controller: a
//! simulated arm that takes as long as a real one, or a board on a port. Pages reach it by
//! websocket. What they ask goes to the controller as orders, so every limit and every
//! refusal is the controller's own. One page is in control, the others watch; anyone may
//! stop the arm. The machine keeps up the client only as long as the page in control
//! shows signs of life: when it falls silent, so does the host, and the controller's
//! command timeout brings the arm to rest.
//!
//! | module | what it holds |
//! |---|---|
//! | `simulated`, `pace` | the simulated arm in real time, or beside a board that is stepped |
//! | `arm`, `maps` | the arm and its workspace as pages know them before it moves |
//! | `machine`, `move_feeder` | the client, the moves in hand |
//! | `requests`, `refusal` | what pages request, and why not in sentences |
//! | `preview` | the arm and its jobs as lines to draw |
//! | `lease` | which page is in control, and whether it lives |
//! | `message` | what pages and server say to each other |
//! | `guard` | who may connect |
//! | `web` | the pages and their websockets |

mod arm;
mod guard;
mod lease;
mod machine;
mod maps;
mod message;
mod move_feeder;
mod pace;
mod preview;
mod refusal;
mod requests;
mod simulated;
mod web;

pub use guard::Guard;

use crate::input::robot::{NoHome, NoWorkspace, Robot};
use crate::run::drive::{Drive, DriveError};
use crate::run::link::{Client, Emulator, EmulatorError, LinkError, PortError, SerialLine};
use crate::run::simulation::RunError;
use fivebar_design::workspace::GridError;
use fivebar_firmware::protocol::{Board, Refusal};
use machine::{Line, Machine};
use simulated::SteppedArm;
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::path::Path;

/// The controller that pages look at.
#[derive(Clone, Copy, Debug)]
pub enum Source<'a> {
    /// In this process, moving the simulated arm in real time.
    Simulated,
    /// The firmware's image on an emulated board, moving the simulated arm.
    Emulated(&'a Path),
    /// On a serial port, moving its own arm; a board with the image `qemu` moves the
    /// simulated one.
    Port {
        /// The port.
        name: &'a str,
        /// Whether the robot's settings are given to it and stored there.
        upload: bool,
    },
}

/// Why the page is not, or no longer, served.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The address cannot be had.
    #[error("cannot listen on {address}: {source}; choose another one with --listen")]
    Listen {
        /// The address asked for.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// The web server failed.
    #[error("the web server failed: {0}")]
    Web(#[from] io::Error),
    /// The robot cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] RunError),
    /// The robot has no place to start from.
    #[error(transparent)]
    NoHome(#[from] NoHome),
    /// The robot's workspace cannot be mapped.
    #[error(transparent)]
    NoWorkspace(#[from] NoWorkspace),
    /// Nor can it with these links.
    #[error("the robot's workspace: {0}")]
    Grid(#[from] GridError),
    /// The port cannot be had.
    #[error(transparent)]
    Port(#[from] PortError),
    /// No emulated board runs.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The controller believes in another arm.
    #[error(transparent)]
    OtherArm(#[from] DriveError),
    /// An emulated board does not take the robot's settings.
    #[error("the emulated board refuses the robot's settings: {0}")]
    Refused(Refusal),
    /// The controller does not answer, or no longer.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The controller's settings describe no arm.
    #[error("the controller's settings: {0}")]
    Settings(#[from] fivebar_firmware::settings::SettingsError),
}

/// Serves the page at `address` until `ends` says so or the controller's line breaks.
/// `ready` is told the address once pages are served.
///
/// # Errors
/// An address or a port that cannot be had, a robot that cannot be simulated, a controller
/// of another arm, or one that does not answer or no longer does.
pub fn serve(
    robot: &Robot,
    source: Source<'_>,
    address: SocketAddr,
    guard: Guard,
    ready: impl FnOnce(SocketAddr),
    ends: impl Fn() -> bool + Send + 'static,
) -> Result<(), ServeError> {
    let listener = TcpListener::bind(address);
    let listener = listener.map_err(|source| ServeError::Listen { address, source })?;
    let line: Box<dyn Line> = match source {
        Source::Simulated => Box::new(simulated::line(robot)?),
        Source::Emulated(image) => Box::new(Emulator::start(image)?),
        Source::Port { name, .. } => Box::new(SerialLine::open(name)?),
    };
    let (mut client, identity) = Client::open(line)?;
    let settings = robot.settings().map_err(RunError::from)?;
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
            let upload = matches!(source, Source::Port { upload: true, .. });
            Drive::new(&mut client, &|| false).agree_on(&settings, upload)?;
            match source {
                Source::Port { name, .. } => (name, None),
                Source::Simulated | Source::Emulated(_) => ("simulated", None),
            }
        }
    };
    let arm = arm::describe(robot, place)?;
    let maps = maps::describe(robot, settings.assembly())?;
    let (pages, machine_side) = message::channels();
    let machine = Machine::new(client, stepped, robot.clone(), settings, machine_side)?;
    ready(listener.local_addr()?);
    let site = web::Site {
        guard,
        pages,
        arm,
        maps,
    };
    web::run(listener, site, Box::new(move || machine.run(&ends)))
}
