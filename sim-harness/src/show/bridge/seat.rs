//! The machine as a part of the live page's server: pages watch while a sender is in control.

use super::events::CLEARING;
use super::machine::Machine;
use super::protocol::RealTime;
use super::{BridgeError, BridgeOptions, Endpoints, connection, placement};
use crate::input::robot::Robot;
use crate::run::link::LinkError;
use crate::show::serve::ServeError;
use crate::show::serve::source::Opened;
use connection::{Event, Shared};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, mpsc};
use std::time::Instant;

/// Where senders connect to a server; none connect if nothing listens.
pub(in crate::show) struct Seat {
    options: BridgeOptions,
    events: Receiver<Event>,
    shared: Arc<Shared>,
    warning: Option<String>,
}

impl Seat {
    /// A seat that nobody takes.
    pub(in crate::show) fn empty() -> Self {
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
    pub(in crate::show) fn listen(
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
    pub(in crate::show) fn machine(
        self,
        robot: &Robot,
        opened: Opened,
        note: Box<dyn Fn(&str) + Send>,
    ) -> Result<Machine<'static>, ServeError> {
        let placement = placement(robot, &self.options)?;
        let Self {
            options,
            events,
            shared,
            warning,
        } = self;
        let mut machine = Machine::new(opened, placement, &options, events, shared, note, None)?;
        machine.warning = warning;
        Ok(machine)
    }
}

impl Machine<'_> {
    /// Serves the sender in control; returns whether there is one. A new one is admitted only if
    /// `admits`.
    pub(in crate::show) fn serve_seat(&mut self, admits: bool) -> Result<bool, LinkError> {
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
    pub(in crate::show) fn is_taken(&self) -> bool {
        self.sender.is_some()
    }

    /// Stops on the path; the sender can go on.
    pub(in crate::show) fn hold(&mut self) -> Result<(), LinkError> {
        self.at_once(RealTime::Hold)
    }

    /// Latches the emergency stop, whatever the state, and drops what the sender has sent.
    pub(in crate::show) fn emergency_stop(&mut self) -> Result<(), LinkError> {
        self.shared.emergency_stop();
        self.stop_if_asked()?;
        self.clears_from = Instant::now() + CLEARING;
        Ok(())
    }
}
