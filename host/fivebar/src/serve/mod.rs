//! The live page: browsers show an arm and control it through its controller.
//!
//! One thread, the `ControllerThread`, is the host of the controller. The controller runs
//! in this process with a simulated arm in real time, on an emulated board, or on a board
//! behind a serial port. Pages connect by websocket. Their requests go to the controller as
//! host commands, so that all limits and refusals are the controller's own. One page holds
//! the control lease; the others watch, and any page may stop the arm. The thread sends to
//! the controller only while the page in control shows signs of life. Otherwise the
//! controller's command timeout brings the arm to rest.
//!
//! Threads share the work, so that none delays a stop: one for each page, which reads what it sends;
//! the controller's, which waits for the controller only; one that reads and checks jobs; one that
//! plans changes of the working mode; one that passes updates on to the pages; and the web server's, which
//! admits pages. Stops and signs of
//! life pass from a page's thread to the controller's through atomic numbers, past the queue of
//! requests. What a page sends costs its own thread's time only, because the system shares the
//! processor between threads.
//!
//! The controller's thread owns the `Session` with the controller. Senders of G-code may use it beside the
//! pages; the server knows them by the trait [`Senders`](crate::senders::Senders) only.
//!
//! | module | content |
//! |---|---|
//! | `arm`, `maps` | the arm and its workspace, sent to pages before the arm moves |
//! | `controller_thread`, `move_feeder` | the exchange with the controller; the moves that wait |
//! | `requests`, `job_requests`, `held_motion` | what each request of a page does; refusals as sentences |
//! | `job_thread`, `parsed_job` | the thread that reads, checks and plans jobs; a job |
//! | `mode_thread` | the thread that plans changes of the working mode |
//! | `preview`, `strokes`, `trail` | the arm, its jobs and what it draws as lines |
//! | `console` | the page whose console sends G-code |
//! | `stop_signal`, `stops` | stops, on a path past every queue; what they do |
//! | `lease` | which page is in control, and whether it is alive |
//! | `channels` | what else passes between pages and controller |
//! | `updates` | what the controller's thread sends to the pages, without waiting for them |
//! | `message` | the messages between pages and server |
//! | `accept`, `guard` | limits of connections; which web requests are served |
//! | `web` | the page's files and the way to a websocket |
//! | `socket`, `frame_meter`, `backlog`, `rate` | the exchange with a page, and its limits |
//! | `commission` | the guided page of a commissioning, in place of the arm's |
//! | `received` | the exchange with a page whose bytes are known, for tests and the fuzzer |

mod accept;
mod arm;
mod backlog;
mod channels;
pub(super) mod commission;
mod console;
mod controller_thread;
mod frame_meter;
mod guard;
mod held_motion;
mod job_requests;
mod job_thread;
mod lease;
mod maps;
mod message;
mod mode_thread;
mod move_feeder;
mod parsed_job;
mod preview;
#[cfg(test)]
mod random_messages;
mod rate;
#[cfg(any(test, fuzzing))]
pub mod received;
mod requests;
mod socket;
mod stop_signal;
mod stops;
mod strokes;
mod trail;
mod updates;
mod web;

pub use guard::Guard;

use crate::senders::{Endpoints, Listen, SendersError};
use controller_thread::ControllerThread;
use fivebar_design::workspace::GridError;
use fivebar_files::robot::{HomeError, Robot, WorkspaceError};
use fivebar_sim::controller::{ControllerSource, OpenError, open};
use fivebar_sim::link::LinkError;
use fivebar_sim::simulation::RunError;
use fivebar_sim::time_optimal::{JobPlanner, TimeOptimalError};
use std::io;
use std::net::SocketAddr;
use updates::Updates;

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

/// How the page is served.
pub struct ServeOptions {
    /// The address to listen on.
    pub address: SocketAddr,
    /// Which requests are served.
    pub guard: Guard,
    /// Listens for senders of G-code, of which pages' consoles are some.
    pub senders: Listen,
    /// Run jobs as time-optimal motions with this share of the torque limits, 0 to 1; none: the
    /// controller plans them.
    pub time_optimal: Option<f64>,
}

/// Serves the page, and senders of G-code if they are asked for, until `ends` returns
/// true or the connection to the controller fails. Calls `ready` with the addresses as soon as pages
/// are served.
///
/// # Errors
/// The address or the port cannot be opened, the robot cannot be simulated, or its jobs cannot be
/// planned, or the controller has settings for another arm or does not reply.
pub fn serve(
    robot: &Robot,
    source: ControllerSource<'_>,
    options: ServeOptions,
    ready: impl FnOnce(SocketAddr, Option<&Endpoints>),
    ends: impl Fn() -> bool + Send + 'static,
) -> Result<(), ServeError> {
    let address = options.address;
    let planner = options
        .time_optimal
        .map(|share| JobPlanner::new(robot, share));
    let planner = planner.transpose()?;
    let listener = accept::listen(address);
    let listener = listener.map_err(|source| ServeError::Listen { address, source })?;
    let (mut session, place) = open(robot, source)?;
    let arm = arm::describe(robot, &place)?;
    let maps = maps::describe(robot, session.settings.assembly())?;
    let senders = (options.senders)(robot, &mut session, &place);
    let senders = senders.map_err(ServeError::Senders)?;
    let (pages, controller_end, to_pages) = channels::channels();
    let updates = Updates::start(to_pages);
    let thread = ControllerThread::new(
        session,
        senders,
        robot.clone(),
        planner,
        controller_end,
        updates,
    )?;
    ready(listener.local_addr()?, thread.senders.endpoints());
    let site = web::Site {
        guard: options.guard,
        pages,
        arm,
        maps,
    };
    web::run(listener, site, Box::new(move || thread.run(&ends)))
}
