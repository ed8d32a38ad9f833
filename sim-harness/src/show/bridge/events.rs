//! What reaches the machine from its sender: stops at once, lines in order.

use super::connection::{Event, Outlet};
use super::machine::{Machine, Phase};
use super::protocol::{Engine, Input, RealTime, ShareChange};
use super::sender::Sender;
use crate::input::job::Dialect;
use crate::run::link::LinkError;
use crate::show::path_queue::Shares;
use fivebar_firmware::Request;
use fivebar_firmware::safety::State;
use fivebar_firmware::settings::ToolOutputSettings;
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
        self.switch_off()?;
        while let Ok(event) = self.events.try_recv() {
            match event {
                Event::Input(Input::RealTime(RealTime::Emergency)) => break,
                Event::Input(_) => {}
                other => self.take(other)?,
            }
        }
        self.report_emergency();
        Ok(())
    }

    fn switch_off(&mut self) -> Result<(), LinkError> {
        if self.status.state != State::Stopped {
            let _ = self.request(Request::EmergencyStop)?;
        }
        (self.status, self.room) = self.client.status()?;
        self.fault = self.status.fault;
        self.drop_path();
        self.path.set_shares(Shares::WHOLE);
        self.phase = Phase::Ready;
        Ok(())
    }

    /// Tells the sender of the emergency stop. What it has sent before is dropped.
    fn report_emergency(&mut self) {
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
                if self.sender.as_mut().is_some_and(|sender| sender.push(line)) {
                    (self.note)("the sender waits for no answers and is disconnected");
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
        self.path.set_shares(Shares::WHOLE);
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
                self.change_shares(|shares| shares.feed = changed(shares.feed, change));
            }
            RealTime::Rapid(share) => self.change_shares(|shares| shares.rapid = part(share)),
            RealTime::Power(change) => {
                // The level of a servo or a switch is no power.
                if let ToolOutputSettings::Power { .. } = self.settings.tool_output {
                    self.change_shares(|shares| shares.power = changed(shares.power, change));
                }
            }
            RealTime::Speed(share) => self.change_shares(|shares| {
                shares.feed = part(share);
                shares.rapid = part(share);
            }),
            RealTime::CancelJog if self.jogs => self.stop_and_drop()?,
            RealTime::CancelJog => {}
            // It has come since `stop_if_asked` looked; what follows it is not dropped.
            RealTime::Emergency if self.shared.emergency.swap(false, Ordering::SeqCst) => {
                self.switch_off()?;
                self.report_emergency();
            }
            // `stop_if_asked` has done it.
            RealTime::Emergency => {}
        }
        Ok(())
    }

    fn change_shares(&mut self, change: impl FnOnce(&mut Shares)) {
        let mut shares = self.path.shares();
        change(&mut shares);
        self.path.set_shares(shares);
    }

    /// Comes to rest on the path and drops the rest of it.
    fn stop_and_drop(&mut self) -> Result<(), LinkError> {
        let _ = self.request(Request::Stop)?;
        self.path.clear();
        self.phase = Phase::Dropping;
        Ok(())
    }
}

/// A share after a change.
fn changed(share: f32, change: ShareChange) -> f32 {
    part(match change {
        ShareChange::To(to) => to,
        ShareChange::By(by) => (100.0 * share).round() as i32 + by,
    })
}

/// A share in percent, as a part of the whole.
fn part(percent: i32) -> f32 {
    percent as f32 / 100.0
}
