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
//! | `pen`, `macros`, `line_at` | the pen's heights; the robot file's macros; the line under a pointer |
//! | `console` | the page whose console sends G-code |
//! | `stops` | what stops do |
//! | `wire` | what passes between pages and controller: messages, stops, the lease, the channels |
//! | `accept`, `guard` | limits of connections; which web requests are served |
//! | `web` | the page's files and the way to a websocket |
//! | `socket`, `frame_meter`, `backlog`, `rate` | the exchange with a page, and its limits |
//! | `commission` | the guided page of a commissioning, in place of the arm's |
//! | `received` | the exchange with a page whose bytes are known, for tests and the fuzzer |

mod accept;
mod arm;
mod backlog;
pub(super) mod commission;
mod console;
mod controller_thread;
mod error;
mod frame;
mod frame_meter;
mod guard;
mod held_motion;
mod job_requests;
mod job_thread;
mod line_at;
mod macros;
mod maps;
mod memory;
mod mode_thread;
mod move_feeder;
mod packed;
mod parsed_job;
mod pen;
mod preview;
#[cfg(test)]
mod random_messages;
mod rate;
#[cfg(any(test, fuzzing))]
pub mod received;
mod requests;
mod socket;
mod stops;
mod strokes;
mod teaching;
mod trail;
mod web;
mod wire;

pub use error::ServeError;
pub use guard::Guard;

use crate::pen_heights::KeepValues;
use crate::senders::{Endpoints, Listen};
use controller_thread::ControllerThread;
use fivebar_files::job::JobReader;
use fivebar_files::robot::Robot;
use fivebar_sim::clock::Clock;
use fivebar_sim::controller::{ControllerSource, open};
use fivebar_sim::drive_values::DriveValues;
use fivebar_sim::time_optimal::JobPlanner;
use std::net::SocketAddr;
use wire::updates::Updates;

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
    /// Writes what pages keep to the robot file.
    pub keep: KeepValues,
    /// What reads the pages' jobs.
    pub jobs: JobReader,
    /// The time of the simulated arm, and of all that pages and server promise each other.
    pub clock: Clock,
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
    memory::give_back_large_blocks();
    let address = options.address;
    let planner = options
        .time_optimal
        .map(|share| JobPlanner::new(robot, share));
    let planner = planner.transpose()?;
    let listener = accept::listen(address);
    let listener = listener.map_err(|source| ServeError::Listen { address, source })?;
    let (mut session, place) = open(robot, source, &options.clock)?;
    let arm = arm::describe(robot, &place, &DriveValues::of(robot, &session.settings))?;
    let maps = maps::describe(robot, session.settings.assembly())?;
    let senders = (options.senders)(robot, &mut session, &place);
    let senders = senders.map_err(ServeError::Senders)?;
    let (pages, controller_end, to_pages) = wire::channels::channels(options.clock);
    let updates = Updates::start(to_pages);
    let thread = ControllerThread::new(
        session,
        senders,
        robot.clone(),
        (options.jobs, planner, options.keep),
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
