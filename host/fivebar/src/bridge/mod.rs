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
//! | `options` | what the bridge is asked for, and why it ends |
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
mod options;
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
use fivebar_files::robot::Robot;
use fivebar_firmware::settings::CheckedSettings;
use fivebar_sim::controller;
use fivebar_sim::controller::{ControllerSource, OpenError};
use log::PathLog;
use options::Reading;
pub use options::{BridgeError, BridgeOptions};
pub use page_senders::for_pages;
use slot::SenderSlot;

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
    let (mut session, place) = controller::open(robot, source, &options.clock)?;
    let log = log_of(options, &session.settings)?;
    let (desk, connections) = connection::desk(options.dialect, options.clock.clone());
    let listening = connection::listen(options.address, &desk)?;
    let mut slot =
        SenderSlot::new(&mut session, reading, connections, note, log).map_err(OpenError::from)?;
    ready(&listening.endpoints(&place));
    Ok(slot.run(&mut session, ends).map_err(OpenError::from)?)
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
