//! What the bridge is asked for, and why it ends.

use fivebar_files::job::{Dialect, JobOptions, Placement};
use fivebar_files::robot::{HomeError, Robot};
use fivebar_sim::clock::Clock;
use fivebar_sim::controller::OpenError;
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
    /// The time of the simulated arm, and of all that senders and bridge promise each other.
    pub clock: Clock,
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
            clock: Clock::real(),
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

/// How the lines of a new sender are read.
pub(super) struct Reading {
    /// Where X0 Y0 is before any G92.
    pub(super) placement: Placement,
    /// How lines are read where they leave it open.
    pub(super) options: JobOptions,
    /// The only dialect; none: Grbl's until a line is RepRap's.
    pub(super) dialect: Option<Dialect>,
}

impl Reading {
    pub(super) fn new(robot: &Robot, options: &BridgeOptions) -> Result<Self, HomeError> {
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
