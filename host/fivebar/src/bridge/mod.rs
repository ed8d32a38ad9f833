//! The bridge: senders of G-code that speak Grbl 1.1 or RepRap move an arm through its controller.
//!
//! | module | content |
//! |---|---|
//! | `protocol` | from text to orders and answers, without input or output |
//! | `connection` | a sender's connection: a thread each way |
//! | `network`, `terminal`, `console` | senders over TCP, at a pseudo-terminal and in a live page |
//! | `sender` | the sender in control: its lines, and the answers to them |
//! | `slot`, `events` | the slot of the sender in control: stops at once, lines in order |
//! | `orders` | what each order of a line does |
//! | `path_state` | the sender's path, and how far the controller is with it |
//! | `view` | what reports show |
//! | `page_senders` | the sender slot of the live page's server |
//! | `log` | the arm's path as a table |
//!
//! A line is answered when few of its moves wait for the controller, so a sender waits while the
//! controller has enough. Stops, reports and the command to go on pass the waiting lines, and an
//! emergency stop passes the queue of events too: the thread of the controller looks for it before
//! each exchange with the controller.

mod connection;
mod console;
mod events;
mod log;
mod network;
mod orders;
mod page_senders;
mod path_state;
mod protocol;
mod sender;
mod slot;
mod terminal;
#[cfg(test)]
mod tests;
mod view;

use crate::senders::Endpoints;
use fivebar_files::job::{Dialect, JobOptions, Placement};
use fivebar_files::robot::{HomeError, Robot};
use fivebar_firmware::settings::CheckedSettings;
use fivebar_sim::controller;
use fivebar_sim::controller::{ControllerSource, OpenError};
use log::PathLog;
pub use page_senders::for_pages;
use slot::SenderSlot;
use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;

/// What the bridge is asked for.
#[derive(Clone, Debug)]
pub struct BridgeOptions {
    /// Where senders connect over TCP; none: at the pseudo-terminal only.
    pub address: Option<SocketAddr>,
    /// The only dialect; none: Grbl's until a line is RepRap's.
    pub dialect: Option<Dialect>,
    /// The position of X0 Y0 before any G92 [m]; none: home.
    pub origin: Option<[f64; 2]>,
    /// How lines are read where they leave it open.
    pub reading: JobOptions,
    /// The file for a log of the arm's path.
    pub log: Option<PathBuf>,
}

impl BridgeOptions {
    /// Senders of either dialect, also at this address, X0 Y0 at home, no log.
    pub fn at(address: Option<SocketAddr>) -> Self {
        Self {
            address,
            dialect: None,
            origin: None,
            reading: JobOptions::default(),
            log: None,
        }
    }
}

/// Why the bridge ends.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BridgeError {
    /// The bridge cannot listen on the address.
    #[error("cannot listen on {address}: {source}; choose another address")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The system's error.
        source: io::Error,
    },
    /// Senders have no way to connect.
    #[error(
        "this system has no pseudo-terminals: let senders connect over TCP, with an address such as \
         127.0.0.1:8106; every program of this computer can move the arm then"
    )]
    NoTerminal,
    /// The pseudo-terminal cannot be opened.
    #[error("cannot open a pseudo-terminal: {0}")]
    Terminal(io::Error),
    /// The log cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Log {
        /// The log's file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The robot has no home pose.
    #[error(transparent)]
    Home(#[from] HomeError),
    /// The controller cannot be opened, or its connection failed.
    #[error(transparent)]
    Controller(#[from] OpenError),
}

/// Serves senders until `ends` returns true or the connection to the controller fails. Calls
/// `ready` as soon as senders can connect, and `note` with each event that a user should know.
///
/// # Errors
/// The address or the port cannot be opened, the robot cannot be simulated, or the controller
/// has settings for another arm or does not reply.
pub fn bridge(
    robot: &Robot,
    source: ControllerSource<'_>,
    options: &BridgeOptions,
    ready: impl FnOnce(&Endpoints),
    note: Box<dyn Fn(&str) + Send + '_>,
    ends: &dyn Fn() -> bool,
) -> Result<(), BridgeError> {
    let reading = Reading::new(robot, options)?;
    let (mut session, place) = controller::open(robot, source)?;
    let log = log_of(options, &session.settings)?;
    let (desk, connections) = connection::desk(options.dialect);
    let listening = connection::listen(options.address, &desk)?;
    let mut slot =
        SenderSlot::new(&mut session, reading, connections, note, log).map_err(OpenError::from)?;
    ready(&listening.endpoints(&place));
    Ok(slot.run(&mut session, ends).map_err(OpenError::from)?)
}

/// How the lines of a new sender are read.
struct Reading {
    /// Where X0 Y0 is before any G92.
    placement: Placement,
    /// How lines are read where they leave it open.
    options: JobOptions,
    /// The only dialect; none: Grbl's until a line is RepRap's.
    dialect: Option<Dialect>,
}

impl Reading {
    fn new(robot: &Robot, options: &BridgeOptions) -> Result<Self, HomeError> {
        let home = robot.tool_at(&robot.home_pose()?);
        let placement = Placement {
            origin: options.origin.unwrap_or(home),
            scale: 1.0,
            turn: 0.0,
            home,
        };
        Ok(Self {
            placement,
            options: JobOptions {
                levels: robot.tool_levels(),
                ..options.reading
            },
            dialect: options.dialect,
        })
    }
}

fn log_of(
    options: &BridgeOptions,
    settings: &CheckedSettings,
) -> Result<Option<PathLog>, BridgeError> {
    let Some(path) = &options.log else {
        return Ok(None);
    };
    let log = PathLog::create(path, settings.control.tick_rate.into());
    log.map(Some).map_err(|source| BridgeError::Log {
        path: path.clone(),
        source,
    })
}
