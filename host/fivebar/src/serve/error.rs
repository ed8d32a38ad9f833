//! Why the page cannot be served.

use crate::senders::SendersError;
use fivebar_design::workspace::GridError;
use fivebar_files::robot::{HomeError, WorkspaceError};
use fivebar_kinematics::five_bar::GeometryError;
use fivebar_sim::controller::OpenError;
use fivebar_sim::link::LinkError;
use fivebar_sim::simulation::RunError;
use fivebar_sim::time_optimal::TimeOptimalError;
use std::io;
use std::net::SocketAddr;

/// Why the page cannot be served.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ServeError {
    /// The server cannot listen on the address.
    #[error("cannot listen on {address}: {source}; choose another address with --listen")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// The system's error.
        source: io::Error,
    },
    /// Senders cannot connect.
    #[error("senders: {0}")]
    Senders(#[source] SendersError),
    /// The web server failed.
    #[error("the web server failed: {0}")]
    Web(#[from] io::Error),
    /// The robot cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] RunError),
    /// The arm cannot be commissioned.
    #[error("{0}")]
    Commission(String),
    /// The robot has no home pose.
    #[error(transparent)]
    HomeError(#[from] HomeError),
    /// The robot's links close no arm.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The robot's workspace cannot be mapped.
    #[error(transparent)]
    WorkspaceError(#[from] WorkspaceError),
    /// The grid of the map cannot be made.
    #[error("the robot's workspace: {0}")]
    Grid(#[from] GridError),
    /// Jobs of this robot cannot be planned time-optimally.
    #[error("--time-optimal: {0}")]
    TimeOptimal(#[from] TimeOptimalError),
    /// The controller cannot be opened.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The controller does not reply.
    #[error(transparent)]
    Link(#[from] LinkError),
}
