//! What the sender slot receives from senders: stops at once, lines in order.

use super::connection::{Event, Outlet, Presence, Visitor};
use super::protocol::{Engine, Input, RealTime, ShareChange};
use super::sender::Sender;
use super::slot::{CLEARING, Phase, SenderSlot, moves, tool};
use fivebar_files::job::Dialect;
use fivebar_firmware::Request;
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::settings::ToolOutputSettings;
use fivebar_sim::controller::Session;
use fivebar_sim::link::LinkError;
use fivebar_sim::path_queue::Shares;
use std::sync::Arc;
use std::time::Duration;

/// A sender that has been silent for this time loses control to another one, if the arm rests.
/// Senders ask for reports every few seconds, also in a pause.
const LONGEST_SILENCE: Duration = Duration::from_secs(10);

/// Sent to a sender that connects while a page moves the arm.
const PAGE_MOVES: &str = "[MSG:the live page moves the arm: connect when it rests]\nerror:9\n";
/// Sent to a sender that connects while another one is in control.
const BUSY: &str = "[MSG:another sender is in control: disconnect it first]\nerror:9\n";
/// Sent to a sender that loses control to another one.
const LOST: &str = "[MSG:another sender is in control now, because this one was silent]\n";

impl SenderSlot<'_> {
    /// Does an emergency stop, if one was asked for: bridges off, and all that was sent before it
    /// is dropped.
    pub(super) fn stop_if_asked(&mut self, session: &mut Session) -> Result<(), LinkError> {
        let Some(latches) = self.connections.shared.take_stop() else {
            return Ok(());
        };
        self.switch_off(session, latches)?;
        while let Ok(event) = self.connections.events.try_recv() {
            match event {
                Event::Input(_, Input::RealTime(RealTime::Reset | RealTime::Emergency)) => break,
                Event::Input(..) => {}
                other => self.take(session, other)?,
            }
        }
        self.report_emergency(session);
        Ok(())
    }

    /// Latches the emergency stop. Bridges that are off stay as they are unless it `latches` in any
    /// case.
    fn switch_off(&mut self, session: &mut Session, latches: bool) -> Result<(), LinkError> {
        let had_fault = session.status.fault.is_some();
        if latches || session.status.state != State::Stopped {
            let _ = session.request(Request::EmergencyStop)?;
        }
        self.path.free = session.read_status()?;
        self.fault.latched = session.status.fault;
        if !had_fault && self.fault.latched == Some(Fault::EmergencyStop) {
            // It is the sender's own stop, which it may clear at once.
            self.fault.clears_from = session.clock.now();
        }
        self.drop_path(session);
        self.path.queue.set_shares(Shares::WHOLE);
        self.phase = Phase::Ready;
        Ok(())
    }

    /// Reports the emergency stop to the sender. What it has sent before is dropped.
    fn report_emergency(&mut self, session: &Session) {
        let locked = self.fault.latched.is_some() || !session.status.homed;
        if let Some(sender) = &mut self.sender {
            sender.drop_lines();
            sender.engine.forget_numbers();
            let dialect = sender.dialect;
            if self.fault.latched.is_some() {
                let why = "emergency stop, the bridges are off";
                sender.outlet.send(&Engine::alarm(dialect, why));
            }
            if dialect == Dialect::Grbl {
                sender.outlet.send(&Engine::greeting(dialect, locked));
            }
        }
    }

    pub(super) fn take_events(&mut self, session: &mut Session) -> Result<(), LinkError> {
        let ended = |sender: &mut Sender| {
            let why = sender.outlet.presence.ended()?.to_owned();
            sender.lost.is_none().then(|| {
                sender.drop_lines();
                sender.lost = Some(why);
            })
        };
        if self.sender.as_mut().and_then(ended).is_some() {
            self.stop_and_drop(session)?;
        }
        while let Ok(event) = self.connections.events.try_recv() {
            self.take(session, event)?;
        }
        if let Some(sender) = &self.sender
            && sender.outlet.presence.takes_report()
        {
            sender
                .outlet
                .send(&sender.engine.report(&self.view(session)));
        }
        Ok(())
    }

    fn take(&mut self, session: &mut Session, event: Event) -> Result<(), LinkError> {
        match event {
            Event::Asks(visitor) => self.answer(session, visitor),
            // It was sent before its sender lost control.
            Event::Input(from, _) if !self.is_in_control(&from) => {}
            Event::Input(_, Input::Line(line)) => {
                if self.sender.as_mut().is_some_and(|sender| sender.push(line)) {
                    (self.note)("the sender waits for no answers and is disconnected");
                }
            }
            Event::Input(_, Input::RealTime(command)) => self.at_once(session, command)?,
        }
        Ok(())
    }

    /// Whether this is the connection of the sender in control, and has not ended.
    fn is_in_control(&self, presence: &Arc<Presence>) -> bool {
        let sender = self.sender.as_ref().filter(|sender| sender.lost.is_none());
        sender.is_some_and(|sender| Arc::ptr_eq(&sender.outlet.presence, presence))
    }

    /// Gives a sender control, or refuses it with the reason.
    fn answer(&mut self, session: &Session, visitor: Visitor) {
        match &self.sender {
            None if !self.admits => return visitor.refuse(PAGE_MOVES),
            None => {}
            Some(sender) if self.may_lose_control(session, sender) => {
                sender.outlet.send(LOST);
                sender.outlet.end();
                let peer = &sender.outlet.presence.peer;
                (self.note)(&format!(
                    "{peer} was silent and loses control to another sender"
                ));
                self.sender = None;
                self.drop_path(session);
            }
            Some(_) => return visitor.refuse(BUSY),
        }
        self.open(session, visitor.admit());
    }

    /// Whether a sender has been silent for long while the arm rests and no line waits, or in a pause.
    fn may_lose_control(&self, session: &Session, sender: &Sender) -> bool {
        let has_done_all = self.path.queue.is_empty() && sender.has_no_lines();
        let rests = match self.phase {
            Phase::Ready => has_done_all && !moves(&session.status),
            Phase::Held => true,
            Phase::Holding { .. } | Phase::Homing | Phase::Dropping => false,
        };
        rests && sender.outlet.presence.silence() > LONGEST_SILENCE
    }

    fn open(&mut self, session: &Session, outlet: Outlet) {
        let mut engine = Engine::new(
            &self.reading.placement,
            self.reading.options,
            &session.settings,
        );
        if let Some(tool) = tool(&session.status) {
            engine.set_position(tool);
        }
        self.fault.latched = session.status.fault;
        self.phase = Phase::Ready;
        self.path.queue.clear();
        self.path.queue.set_shares(Shares::WHOLE);
        let dialect = self.reading.dialect.unwrap_or(Dialect::Grbl);
        let locked = session.status.fault.is_some() || !session.status.homed;
        outlet.send(&Engine::greeting(dialect, locked));
        (self.note)(&format!("a sender is connected: {}", outlet.presence.peer));
        self.fault.clears_from = outlet.presence.clock.now() + CLEARING;
        self.sender = Some(Sender::new(outlet, engine, dialect));
    }

    /// A lost sender's arm rests before another one may be in control.
    pub(super) fn release_lost_sender(&mut self, session: &Session) {
        let Some(why) = self.sender.as_ref().and_then(|sender| sender.lost.clone()) else {
            return;
        };
        if self.phase == Phase::Ready && !moves(&session.status) {
            self.sender = None;
            (self.note)(&format!("{why}; the arm rests"));
        }
    }

    pub(super) fn at_once(
        &mut self,
        session: &mut Session,
        command: RealTime,
    ) -> Result<(), LinkError> {
        match command {
            RealTime::Hold if self.path.is_jog || self.phase == Phase::Homing => {
                self.stop_and_drop(session)?;
            }
            RealTime::Hold => {
                if self.phase == Phase::Ready {
                    self.read_status(session)?;
                    let from = session.status.reference;
                    let _ = session.request(Request::Stop)?;
                    self.phase = Phase::Holding {
                        from,
                        goes_on: false,
                    };
                }
            }
            RealTime::Resume => match &mut self.phase {
                Phase::Held => self.phase = Phase::Ready,
                Phase::Holding { goes_on, .. } => *goes_on = true,
                Phase::Ready | Phase::Homing | Phase::Dropping => {}
            },
            RealTime::Feed(change) => {
                self.path
                    .change_shares(|shares| shares.feed = changed(shares.feed, change));
            }
            RealTime::Rapid(share) => self.path.change_shares(|shares| shares.rapid = part(share)),
            RealTime::Power(change) => {
                // The level of a servo or a switch is no power.
                if let ToolOutputSettings::Power { .. } = session.settings.tool_output {
                    self.path
                        .change_shares(|shares| shares.power = changed(shares.power, change));
                }
            }
            RealTime::Speed(share) => self.path.change_shares(|shares| {
                shares.feed = part(share);
                shares.rapid = part(share);
            }),
            RealTime::CancelJog if self.path.is_jog => self.stop_and_drop(session)?,
            RealTime::CancelJog => {}
            RealTime::Reset | RealTime::Emergency => {
                // It has come since `stop_if_asked` looked; what follows it is not dropped.
                if let Some(latches) = self.connections.shared.take_stop() {
                    self.switch_off(session, latches)?;
                    self.report_emergency(session);
                }
            }
            // `take_events` answers it.
            RealTime::Report => {}
        }
        Ok(())
    }

    /// Comes to rest on the path and drops the rest of it.
    fn stop_and_drop(&mut self, session: &mut Session) -> Result<(), LinkError> {
        let _ = session.request(Request::Stop)?;
        self.path.queue.clear();
        self.phase = Phase::Dropping;
        Ok(())
    }
}

/// A share after a change.
pub(super) fn changed(share: f32, change: ShareChange) -> f32 {
    part(match change {
        ShareChange::To(to) => to,
        ShareChange::By(by) => (100.0 * share).round() as i32 + by,
    })
}

/// A share in percent, as a part of the whole.
pub(super) fn part(percent: i32) -> f32 {
    percent as f32 / 100.0
}
