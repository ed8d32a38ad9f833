//! The live page: an arm in a browser, moved by its controller and by nothing else.
//!
//! A thread of its own, the `Machine`, holds the conversation with the controller: a
//! simulated arm that takes as long as a real one, or a board on a port. Pages reach it by
//! websocket. What they ask goes to the controller as orders, so every limit and every
//! refusal is the controller's own. One page is in control, the others watch; anyone may
//! stop the arm. The machine keeps up the conversation only as long as the page in control
//! shows signs of life: when it falls silent, so does the host, and the controller's
//! command timeout brings the arm to rest.
//!
//! | module | what it holds |
//! |---|---|
//! | `simulated` | the simulated arm in real time |
//! | `arm` | the arm as pages know it before it moves |
//! | `machine`, `feed` | the conversation, the job in hand |
//! | `refusal` | the controller's refusals in sentences |
//! | `sketch` | the arm and its jobs as lines to draw |
//! | `pilot` | which page is in control, and whether it lives |
//! | `message` | what pages and server say to each other |
//! | `guard` | who may connect |
//! | `web` | the pages and their websockets |

mod arm;
mod feed;
mod guard;
mod machine;
mod message;
mod pilot;
mod refusal;
mod simulated;
mod sketch;
mod web;

pub use guard::Guard;

use crate::link::{Conversation, LinkError, PortError, SerialLine};
use crate::robot::{NoHome, Robot};
use crate::run::{RunError, Scenario};
use machine::Machine;
use std::io;
use std::net::{SocketAddr, TcpListener};

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
    /// The port cannot be had.
    #[error(transparent)]
    Port(#[from] PortError),
    /// The controller does not answer, or no longer.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The controller's settings describe no arm.
    #[error("the controller's settings: {0}")]
    Settings(#[from] fivebar_firmware::settings::SettingsError),
}

/// Serves the page at `address` until the controller's line breaks. The arm is simulated,
/// or moved by the controller on `port`. `ready` is told the address once pages are served.
///
/// # Errors
/// An address or a port that cannot be had, a robot that cannot be simulated, a controller
/// that does not answer or no longer does.
pub fn serve(
    robot: &Robot,
    port: Option<&str>,
    address: SocketAddr,
    guard: Guard,
    ready: impl FnOnce(SocketAddr),
) -> Result<(), ServeError> {
    let listener = TcpListener::bind(address);
    let listener = listener.map_err(|source| ServeError::Listen { address, source })?;
    let (web_side, machine_side) = message::channels();
    let machine: Box<dyn FnOnce() -> ServeError + Send> = match port {
        None => {
            let scenario = Scenario::new("page", robot.clone(), "page", String::new());
            let (conversation, _) = Conversation::open(simulated::line(&scenario)?)?;
            let machine = Machine::new(conversation, robot.clone(), machine_side)?;
            Box::new(move || machine.run())
        }
        Some(port) => {
            let (conversation, _) = Conversation::open(SerialLine::open(port)?)?;
            let machine = Machine::new(conversation, robot.clone(), machine_side)?;
            Box::new(move || machine.run())
        }
    };
    ready(listener.local_addr()?);
    let arm = arm::describe(robot, port.is_none())?;
    web::run(listener, guard, web_side, arm, machine)
}
