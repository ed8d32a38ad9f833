//! What reaches the machine from its sender: stops at once, lines in order.

use super::connection::{Event, Outlet};
use super::machine::{Machine, Phase};
use super::protocol::{Engine, FeedChange, Input, RealTime};
use super::sender::Sender;
use crate::input::job::Dialect;
use crate::run::link::LinkError;
use fivebar_firmware::Request;
use fivebar_firmware::safety::State;
use std::sync::atomic::Ordering;

/// What a sender is told that comes while a page moves the arm.
const BUSY: &str = "[MSG:the live page moves the arm: connect when it rests]\nerror:9\n";

impl Machine<'_> {
    /// Does an emergency stop, if one was asked for: bridges off, and all that was sent before it
    /// is dropped. Bridges that are off stay as they are.
    pub(super) fn stop_if_asked(&mut self) -> Result<(), LinkError> {
        if !self.shared.emergency.swap(false, Ordering::SeqCst) {
            return Ok(());
        }
        if self.status.state != State::Stopped {
            let _ = self.request(Request::EmergencyStop)?;
        }
        (self.status, self.room) = self.client.status()?;
        self.fault = self.status.fault;
        self.drop_path();
        self.phase = Phase::Ready;
        while let Ok(event) = self.events.try_recv() {
            match event {
                Event::Input(Input::RealTime(RealTime::Emergency)) => break,
                Event::Input(_) => {}
                other => self.take(other)?,
            }
        }
        let locked = self.fault.is_some() || !self.status.homed;
        if let Some(sender) = &mut self.sender {
            sender.drop_lines();
            sender.engine.forget_numbers();
            let dialect = sender.dialect;
            if self.fault.is_some() {
                let why = "emergency stop, the bridges are off";
                sender.outlet.send(&Engine::alarm(dialect, why));
            }
            if dialect == Dialect::Grbl {
                sender.outlet.send(&Engine::greeting(dialect, locked));
            }
        }
        Ok(())
    }

    pub(super) fn take_events(&mut self) -> Result<(), LinkError> {
        while let Ok(event) = self.events.try_recv() {
            self.take(event)?;
        }
        Ok(())
    }

    fn take(&mut self, event: Event) -> Result<(), LinkError> {
        match event {
            Event::Opened(outlet) if !self.admits => {
                outlet.send(BUSY);
                outlet.end();
            }
            Event::Opened(outlet) => self.open(outlet),
            // It was not admitted.
            Event::Closed(_) if self.sender.is_none() => {
                self.shared.taken.store(false, Ordering::SeqCst);
            }
            Event::Closed(why) => {
                if let Some(sender) = &mut self.sender {
                    sender.drop_lines();
                    sender.lost = Some(why);
                }
                self.stop_and_drop()?;
            }
            Event::Input(Input::Line(line)) => {
                if let Some(sender) = &mut self.sender {
                    sender.push(line);
                }
            }
            Event::Input(Input::RealTime(command)) => self.at_once(command)?,
            Event::Input(Input::Web) => {}
        }
        Ok(())
    }

    fn open(&mut self, outlet: Outlet) {
        let mut engine = Engine::new(&self.placement, self.reading, &self.settings);
        if let Some(tool) = self.tool() {
            engine.set_position(tool);
        }
        self.fault = self.status.fault;
        self.phase = Phase::Ready;
        self.path.clear();
        let dialect = self.fixed.unwrap_or(Dialect::Grbl);
        let locked = self.status.fault.is_some() || !self.status.homed;
        outlet.send(&Engine::greeting(dialect, locked));
        (self.note)("a sender is connected");
        self.sender = Some(Sender::new(outlet, engine, dialect));
    }

    /// A lost sender's arm rests before another one may be in control.
    pub(super) fn release_lost_sender(&mut self) {
        let Some(why) = self.sender.as_ref().and_then(|sender| sender.lost.clone()) else {
            return;
        };
        if self.phase == Phase::Ready && !self.moves() {
            self.sender = None;
            self.shared.taken.store(false, Ordering::SeqCst);
            (self.note)(&format!("{why}; the arm rests"));
        }
    }

    pub(super) fn at_once(&mut self, command: RealTime) -> Result<(), LinkError> {
        match command {
            RealTime::Report => {
                let view = self.view();
                if let Some(sender) = &self.sender {
                    sender.outlet.send(&sender.engine.report(&view));
                }
            }
            RealTime::Hold if self.jogs || self.phase == Phase::Homing => self.stop_and_drop()?,
            RealTime::Hold => {
                if self.phase == Phase::Ready {
                    self.read_status()?;
                    self.held_at = self.status.reference;
                    let _ = self.request(Request::Stop)?;
                    self.goes_on = false;
                    self.phase = Phase::Hold { rests: false };
                }
            }
            RealTime::Resume => match self.phase {
                Phase::Hold { rests: true } => self.phase = Phase::Ready,
                Phase::Hold { rests: false } => self.goes_on = true,
                Phase::Ready | Phase::Homing | Phase::Dropping => {}
            },
            RealTime::Feed(change) => {
                let share = match change {
                    FeedChange::To(share) => share,
                    FeedChange::By(by) => (100.0 * self.path.feed()).round() as i32 + by,
                };
                self.path.set_feed(share as f32 / 100.0);
            }
            RealTime::CancelJog if self.jogs => self.stop_and_drop()?,
            RealTime::CancelJog => {}
            // `stop_if_asked` has done it.
            RealTime::Emergency => {}
        }
        Ok(())
    }

    /// Comes to rest on the path and drops the rest of it.
    fn stop_and_drop(&mut self) -> Result<(), LinkError> {
        let _ = self.request(Request::Stop)?;
        self.path.clear();
        self.phase = Phase::Dropping;
        Ok(())
    }
}
