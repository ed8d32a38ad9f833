//! The machine as a part of the live page's server: pages watch while a sender is in control.

use super::machine::Machine;
use super::protocol::RealTime;
use super::{BridgeError, BridgeOptions, Endpoints, connection, placement};
use crate::input::robot::Robot;
use crate::run::link::LinkError;
use crate::show::serve::ServeError;
use crate::show::serve::source::Opened;
use connection::{Event, Shared};
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::atomic::Ordering;
use std::sync::mpsc::Receiver;
use std::sync::{Arc, mpsc};

/// Where senders connect to a server; none connect if nothing listens.
pub(in crate::show) struct Seat {
    options: BridgeOptions,
    events: Receiver<Event>,
    shared: Arc<Shared>,
}

impl Seat {
    /// A seat that nobody takes.
    pub(in crate::show) fn empty() -> Self {
        let (_, events) = mpsc::channel();
        let options = BridgeOptions::at(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)));
        let shared = Arc::default();
        Self {
            options,
            events,
            shared,
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
        } = self;
        Machine::new(opened, placement, &options, events, shared, note, None)
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

    /// Switches the bridges off and drops what the sender has sent.
    pub(in crate::show) fn emergency_stop(&mut self) -> Result<(), LinkError> {
        self.shared.emergency.store(true, Ordering::SeqCst);
        self.stop_if_asked()
    }
}
