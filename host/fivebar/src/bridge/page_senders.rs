//! Senders beside the live page: pages watch while one of them is in control.

use super::connection::{Desk, Presence};
use super::options::{BridgeError, BridgeOptions, Reading};
use super::protocol::RealTime;
use super::sender::Sender;
use super::slot::{CLEARING, Phase, SenderSlot, moves};
use super::{connection, console};
use crate::senders::{Console, Endpoints, Listen, Senders};
use fivebar_files::robot::Robot;
use fivebar_sim::controller::{OpenError, Session};
use fivebar_sim::link::LinkError;
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Weak};

/// The sender slot of a page's server.
pub(super) struct PageSenders {
    pub(super) slot: SenderSlot<'static>,
    pub(super) endpoints: Option<Endpoints>,
    pub(super) notes: Receiver<String>,
    /// Where consoles ask for control.
    pub(super) desk: Desk,
    /// The console that was opened last.
    pub(super) console: Weak<Presence>,
}

/// The senders of a page's server: consoles of pages, and others if the options are given.
pub fn for_pages(options: Option<BridgeOptions>) -> Listen {
    Box::new(move |robot, session, place| {
        listen(robot, options.as_ref(), session, place).map_err(Into::into)
    })
}

/// Lets pages' consoles move the arm of this session and, if the options are given, listens for other senders. Its
/// controller runs at `place`.
///
/// # Errors
/// The address or the terminal cannot be opened, the robot has no home pose, or the controller does
/// not reply.
fn listen(
    robot: &Robot,
    options: Option<&BridgeOptions>,
    session: &mut Session,
    place: &str,
) -> Result<Box<dyn Senders>, BridgeError> {
    let consoles_only = BridgeOptions::at(None);
    let reading = Reading::new(robot, options.unwrap_or(&consoles_only))?;
    let (desk, connections) = connection::desk(reading.dialect, session.clock.clone());
    let endpoints = options.map(|options| connection::listen(options.address, &desk));
    let endpoints = endpoints.transpose()?;
    let (sender, notes) = mpsc::channel();
    // It fails only when the page's server has ended.
    let note = Box::new(move |text: &str| drop(sender.send(text.to_owned())));
    let slot =
        SenderSlot::new(session, reading, connections, note, None).map_err(OpenError::from)?;
    Ok(Box::new(PageSenders {
        slot,
        endpoints: endpoints.map(|listening| listening.endpoints(place)),
        notes,
        desk,
        console: Weak::new(),
    }))
}

impl Senders for PageSenders {
    fn endpoints(&self) -> Option<&Endpoints> {
        self.endpoints.as_ref()
    }

    fn open_console(&mut self) -> Console {
        let (console, presence) = console::open(self.desk.clone());
        self.console = Arc::downgrade(&presence);
        console
    }

    fn is_console_in_control(&self) -> bool {
        let sender = self.slot.sender.as_ref();
        sender.is_some_and(|sender| {
            Weak::ptr_eq(&Arc::downgrade(&sender.outlet.presence), &self.console)
        })
    }

    fn is_console_idle(&self, session: &Session) -> bool {
        let is_held = self.slot.phase == Phase::Held;
        let has_done_all = self.slot.phase == Phase::Ready && self.slot.path.queue.is_empty();
        let sender = self.slot.sender.as_ref();
        self.is_console_in_control()
            && !moves(&session.status)
            && (is_held || has_done_all && sender.is_some_and(Sender::has_no_lines))
    }

    fn release_console(&mut self, session: &Session) -> bool {
        let is_idle = self.is_console_idle(session);
        if is_idle {
            self.slot.sender = None;
            self.slot.drop_path(session);
            self.slot.phase = Phase::Ready;
        }
        is_idle
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
        self.slot.fault.clears_from = session.clock.now() + CLEARING;
        Ok(())
    }

    fn take_note(&mut self) -> Option<String> {
        self.notes.try_recv().ok()
    }
}
