//! The bridge: senders of G-code that speak Grbl 1.1 or RepRap move an arm through its controller.
//!
//! | module | content |
//! |---|---|
//! | `protocol` | from text to orders and answers, without input or output |
//! | `connection` | a sender's connection: a thread each way |
//! | `network`, `terminal` | senders over TCP and at a pseudo-terminal |
//! | `sender` | the sender in control: its lines, and the answers to them |
//! | `machine`, `events` | the thread of the controller: stops at once, lines in order, reports |
//! | `view` | what reports tell of the machine |
//! | `seat` | the machine as a part of the live page's server |
//! | `log` | the arm's path as a table |
//! | `orders` | what each order of a line does |
//!
//! A line is answered when few of its moves wait for the controller, so a sender waits while the
//! controller has enough. Stops, reports and the way on pass the waiting lines, and an
//! emergency stop passes the queue of events too: the machine looks for it before each exchange
//! with the controller.

mod connection;
mod events;
mod log;
mod machine;
mod network;
mod orders;
mod protocol;
mod seat;
mod sender;
mod terminal;
mod view;

use connection::Shared;
use fivebar_files::job::{Dialect, JobOptions, Placement};
use fivebar_files::robot::{HomeError, Robot};
use fivebar_firmware::settings::CheckedSettings;
use fivebar_sim::controller;
use fivebar_sim::controller::{ControllerSource, OpenError};
use log::PathLog;
pub(crate) use machine::Machine;
pub(crate) use seat::Seat;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::{fmt, io};

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

/// Where the bridge is reached.
#[derive(Clone, Debug)]
pub struct Endpoints {
    /// The address for TCP, if it was asked for.
    pub address: Option<SocketAddr>,
    /// The pseudo-terminal, on systems that have them.
    pub terminal: Option<String>,
    /// Where the controller runs.
    pub place: String,
}

/// The address and the terminal, two words.
impl fmt::Display for Endpoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.address {
            Some(address) => write!(f, "{address}")?,
            None => write!(f, "no-tcp")?,
        }
        write!(f, " {}", self.terminal.as_deref().unwrap_or("no-terminal"))
    }
}

impl Endpoints {
    /// Who can move the arm over TCP, if anybody can.
    pub fn warning(&self) -> Option<String> {
        let address = self.address?;
        let who = match address.ip().is_loopback() {
            true => "every user and program of this computer",
            false => "every computer that reaches it",
        };
        Some(format!(
            "WARNING: no password protects {address}: {who} can move the arm there"
        ))
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
    let placement = placement(robot, options)?;
    let opened = controller::open(robot, source)?;
    let place = opened.place.clone();
    let log = log_of(options, &opened.settings)?;
    let shared = Arc::new(Shared::default());
    let (address, terminal, events) =
        connection::listen(options.address, options.dialect, &shared)?;
    let mut machine = machine::Machine::new(opened, placement, options, events, shared, note, log)
        .map_err(OpenError::from)?;
    ready(&Endpoints {
        address,
        terminal,
        place,
    });
    Ok(machine.run(ends).map_err(OpenError::from)?)
}

/// Where X0 Y0 is before any G92.
fn placement(robot: &Robot, options: &BridgeOptions) -> Result<Placement, HomeError> {
    let home = robot.tool_at(&robot.home_pose()?);
    Ok(Placement {
        origin: options.origin.unwrap_or(home),
        scale: 1.0,
        turn: 0.0,
        home,
    })
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
