//! The machine as a part of the live page's server: pages watch while a sender is in control.

use super::events::CLEARING;
use super::machine::Machine;
use super::protocol::RealTime;
use super::{BridgeError, BridgeOptions, Endpoints, connection, placement};
use connection::{Event, Shared};
use fivebar_files::robot::Robot;
use fivebar_sim::controller::{OpenError, Opened};
use fivebar_sim::link::LinkError;
use std::sync::mpsc::Receiver;
use std::sync::{Arc, mpsc};
use std::time::Instant;

/// Where senders connect to a server; none connect if nothing listens.
pub(crate) struct Seat {
    options: BridgeOptions,
    events: Receiver<Event>,
    shared: Arc<Shared>,
    warning: Option<String>,
}

impl Seat {
    /// A seat that nobody takes.
    pub(crate) fn empty() -> Self {
        let (_, events) = mpsc::channel();
        let options = BridgeOptions::at(None);
        let shared = Arc::default();
        Self {
            options,
            events,
            shared,
            warning: None,
        }
    }

    /// Listens for senders.
    pub(crate) fn listen(
        options: &BridgeOptions,
        place: &str,
    ) -> Result<(Self, Endpoints), BridgeError> {
        let shared = Arc::default();
        let (address, terminal, events) =
            connection::listen(options.address, options.dialect, &shared)?;
        let endpoints = Endpoints {
            address,
            terminal,
            place: place.into(),
        };
        let options = options.clone();
        let seat = Self {
            options,
            events,
            shared,
            warning: endpoints.warning(),
        };
        Ok((seat, endpoints))
    }

    /// The machine that serves the seat.
    pub(crate) fn machine(
        self,
        robot: &Robot,
        opened: Opened,
        note: Box<dyn Fn(&str) + Send>,
    ) -> Result<Machine<'static>, BridgeError> {
        let placement = placement(robot, &self.options)?;
        let Self {
            options,
            events,
            shared,
            warning,
        } = self;
        let mut machine = Machine::new(opened, placement, &options, events, shared, note, None)
            .map_err(OpenError::from)?;
        machine.warning = warning;
        Ok(machine)
    }
}

impl Machine<'_> {
    /// Serves the sender in control; returns whether there is one. A new one is admitted only if
    /// `admits`.
    pub(crate) fn serve_seat(&mut self, admits: bool) -> Result<bool, LinkError> {
        self.admits = admits;
        if !self.is_taken() {
            self.take_events()?;
        }
        if !self.is_taken() {
            return Ok(false);
        }
        self.serve_sender()?;
        Ok(true)
    }

    /// Whether a sender is in control.
    pub(crate) fn is_taken(&self) -> bool {
        self.sender.is_some()
    }

    /// Stops on the path; the sender can go on.
    pub(crate) fn hold(&mut self) -> Result<(), LinkError> {
        self.at_once(RealTime::Hold)
    }

    /// Latches the emergency stop, whatever the state, and drops what the sender has sent.
    pub(crate) fn emergency_stop(&mut self) -> Result<(), LinkError> {
        self.shared.emergency_stop();
        self.stop_if_asked()?;
        self.clears_from = Instant::now() + CLEARING;
        Ok(())
    }
}
