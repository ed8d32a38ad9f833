//! Senders beside the live page: pages watch while one of them is in control.

use super::events::CLEARING;
use super::protocol::RealTime;
use super::slot::SenderSlot;
use super::{BridgeError, BridgeOptions, Reading, connection};
use crate::senders::{Endpoints, Senders};
use fivebar_files::robot::Robot;
use fivebar_sim::controller::{OpenError, Session};
use fivebar_sim::link::LinkError;
use std::sync::mpsc::{self, Receiver};
use std::time::Instant;

/// The sender slot of a page's server.
pub(super) struct PageSenders {
    pub(super) slot: SenderSlot<'static>,
    pub(super) endpoints: Endpoints,
    pub(super) notes: Receiver<String>,
}

/// Listens for senders that may move the arm of this session. Its controller runs at `place`.
///
/// # Errors
/// The address or the terminal cannot be opened, the robot has no home pose, or the controller does
/// not reply.
pub(crate) fn listen(
    robot: &Robot,
    options: &BridgeOptions,
    session: &mut Session,
    place: &str,
) -> Result<Box<dyn Senders>, BridgeError> {
    let reading = Reading::new(robot, options)?;
    let listening = connection::listen(options.address, options.dialect)?;
    let (sender, notes) = mpsc::channel();
    // It fails only when the page's server has ended.
    let note = Box::new(move |text: &str| drop(sender.send(text.to_owned())));
    let slot = SenderSlot::new(session, reading, listening.connections, note, None)
        .map_err(OpenError::from)?;
    let endpoints = Endpoints {
        address: listening.address,
        terminal: listening.terminal,
        place: place.into(),
    };
    Ok(Box::new(PageSenders {
        slot,
        endpoints,
        notes,
    }))
}

impl Senders for PageSenders {
    fn endpoints(&self) -> &Endpoints {
        &self.endpoints
    }

    fn serve(&mut self, session: &mut Session, admits: bool) -> Result<bool, LinkError> {
        self.slot.admits = admits;
        if !self.is_in_control() {
            self.slot.take_events(session)?;
        }
        if !self.is_in_control() {
            return Ok(false);
        }
        self.slot.serve_sender(session)?;
        Ok(true)
    }

    fn is_in_control(&self) -> bool {
        self.slot.sender.is_some()
    }

    fn hold(&mut self, session: &mut Session) -> Result<(), LinkError> {
        self.slot.at_once(session, RealTime::Hold)
    }

    fn emergency_stop(&mut self, session: &mut Session) -> Result<(), LinkError> {
        self.slot.connections.shared.emergency_stop();
        self.slot.stop_if_asked(session)?;
        self.slot.fault.clears_from = Instant::now() + CLEARING;
        Ok(())
    }

    fn take_note(&mut self) -> Option<String> {
        self.notes.try_recv().ok()
    }
}
