//! A sender slot, and senders whose bytes a test gives.

use crate::bridge::connection::{Connections, Desk, Event, Outlet, Presence, desk};
use crate::bridge::sender;
use crate::bridge::slot::SenderSlot;
use crate::bridge::{BridgeOptions, Reading};
use crate::test_session::{self, ROUNDS, robot};
use fivebar_firmware::Status;
use fivebar_firmware::safety::State;
use fivebar_sim::controller::Session;
use std::io::ErrorKind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

pub(super) struct Rig {
    pub(super) session: Session,
    pub(super) slot: SenderSlot<'static>,
    notes: Receiver<String>,
    pub(super) desk: Desk,
    relay: Arc<Relay>,
}

/// Passes events on to the slot, so that a test knows when they are there.
struct Relay {
    from: Mutex<Receiver<Event>>,
    to: Sender<Event>,
}

impl Relay {
    /// Waits for the next event.
    fn wait(&self) {
        let event = self.from.lock().unwrap().recv();
        self.to.send(event.expect("an event")).unwrap();
    }

    fn pass_on(&self) {
        for event in self.from.lock().unwrap().try_iter() {
            self.to.send(event).unwrap();
        }
    }
}

/// A sender.
pub(super) struct Caller {
    pub(super) presence: Arc<Presence>,
    /// Its bytes. Its thread takes each piece only when it has done the one before.
    bytes: SyncSender<Vec<u8>>,
    received: Arc<Mutex<String>>,
    closed: Arc<AtomicBool>,
    relay: Arc<Relay>,
}

impl Rig {
    /// An arm that is not homed.
    pub(super) fn new() -> Self {
        Self::with(test_session::session())
    }

    pub(super) fn homed() -> Self {
        Self::with(test_session::homed())
    }

    fn with(mut session: Session) -> Self {
        let (desk, from) = desk(None, session.clock.clone());
        let (to, events) = mpsc::channel();
        let connections = Connections {
            events,
            shared: from.shared,
        };
        let relay = Arc::new(Relay {
            from: Mutex::new(from.events),
            to,
        });
        let (sender, notes) = mpsc::channel();
        let note = Box::new(move |text: &str| drop(sender.send(text.to_owned())));
        let reading = Reading::new(&robot(), &BridgeOptions::at(None)).unwrap();
        let slot = SenderSlot::new(&mut session, reading, connections, note, None).unwrap();
        Self {
            session,
            slot,
            notes,
            desk,
            relay,
        }
    }

    /// A sender that asks for control, which the slot has not yet answered.
    pub(super) fn call(&self) -> Caller {
        let presence = self.desk.presence("a test");
        let (bytes, input) = mpsc::sync_channel::<Vec<u8>>(0);
        let received = Arc::<Mutex<String>>::default();
        let closed = Arc::<AtomicBool>::default();
        let (text, end) = (Arc::clone(&received), Arc::clone(&closed));
        let write = move |answer: &str| {
            text.lock().unwrap().push_str(answer);
            true
        };
        let close = move || end.store(true, Ordering::SeqCst);
        let outlet = Outlet::start(Arc::clone(&presence), write, close);
        let (desk, gate) = (self.desk.clone(), self.desk.guarded_gate());
        let line = Arc::clone(&presence);
        thread::spawn(move || {
            if desk.ask(outlet) {
                desk.pass_on(&line, gate, |buffer| match input.recv() {
                    Ok(bytes) if bytes.is_empty() => Err(ErrorKind::TimedOut.into()),
                    Ok(bytes) => {
                        buffer[..bytes.len()].copy_from_slice(&bytes);
                        Ok(bytes.len())
                    }
                    Err(_) => Ok(0),
                });
            }
        });
        self.relay.wait();
        Caller {
            presence,
            bytes,
            received,
            closed,
            relay: Arc::clone(&self.relay),
        }
    }

    /// A sender in control, which has read its greeting.
    pub(super) fn connect(&mut self) -> Caller {
        let caller = self.call();
        self.until(|rig| rig.slot.sender.is_some());
        self.answer(&caller);
        caller
    }

    /// Serves the slot once, and passes 10 ms.
    pub(super) fn round(&mut self) {
        self.slot.serve_sender(&mut self.session).unwrap();
        self.session.pass_time().unwrap();
    }

    /// Serves the slot until this is so.
    pub(super) fn until(&mut self, wanted: impl Fn(&Self) -> bool) {
        for _ in 0..ROUNDS {
            if wanted(self) {
                return;
            }
            self.round();
        }
        panic!("it takes long: {:?}, {:?}", self.slot.phase, self.status());
    }

    pub(super) fn until_rest(&mut self) {
        self.until(Self::rests);
    }

    /// Whether the arm rests and nothing waits.
    pub(super) fn rests(&self) -> bool {
        let done = self
            .slot
            .sender
            .as_ref()
            .is_none_or(sender::Sender::has_no_lines);
        done && self.slot.path.queue.is_empty() && self.state() != State::Running
    }

    pub(super) fn status(&self) -> Status {
        self.session.status
    }

    pub(super) fn state(&self) -> State {
        self.session.status.state
    }

    /// What the sender was sent since the last call, with all that the slot has sent so far.
    pub(super) fn answer(&self, caller: &Caller) -> String {
        const MARK: &str = "#";
        if let Some(sender) = &self.slot.sender
            && Arc::ptr_eq(&sender.outlet.presence, &caller.presence)
            && caller.presence.ended().is_none()
        {
            sender.outlet.send(MARK);
            caller.wait_for(MARK);
        }
        std::mem::take(&mut *caller.received.lock().unwrap()).replace(MARK, "")
    }

    /// What the sender is sent until its lines are done and the arm rests.
    pub(super) fn asked(&mut self, caller: &Caller, text: &str) -> String {
        caller.say(text);
        self.round();
        self.until_rest();
        self.answer(caller)
    }

    /// The answer to `?`.
    pub(super) fn report(&mut self, caller: &Caller) -> String {
        caller.say("?");
        self.round();
        let answer = self.answer(caller);
        let reports: Vec<_> = answer
            .lines()
            .filter(|line| line.starts_with('<'))
            .collect();
        assert_eq!(reports.len(), 1, "{answer}");
        reports[0].into()
    }

    /// The next thing that a user should know.
    pub(super) fn note(&self) -> Option<String> {
        self.notes.try_recv().ok()
    }

    pub(super) fn into_parts(self) -> (SenderSlot<'static>, Session, Receiver<String>) {
        (self.slot, self.session, self.notes)
    }

    /// A sender that follows a line of 40 mm at 3 m/min.
    pub(super) fn drawing(&mut self) -> Caller {
        let caller = self.connect();
        caller.say("G91 G1 X-40 F3000\n");
        self.until(|rig| rig.state() == State::Running);
        self.answer(&caller);
        caller
    }
}

impl Caller {
    /// Sends bytes; they are read when this returns.
    pub(super) fn say(&self, text: &str) {
        self.send(text.as_bytes());
    }

    pub(super) fn send(&self, bytes: &[u8]) {
        let ended = "a connection that has not ended";
        self.bytes.send(bytes.to_vec()).expect(ended);
        self.bytes.send(Vec::new()).expect(ended);
        self.relay.pass_on();
    }

    /// Sends bytes by which the connection ends.
    pub(super) fn say_last(&self, text: &str) {
        let ended = "a connection that has not ended";
        self.bytes.send(text.into()).expect(ended);
        until(|| self.presence.ended().is_some());
    }

    /// Closes the connection; it has ended when this returns.
    pub(super) fn hang_up(self) -> Arc<Presence> {
        drop(self.bytes);
        until(|| self.presence.ended().is_some());
        self.presence
    }

    /// Passes time until the sender has been silent for this long.
    pub(super) fn be_silent(&self, silence: Duration) {
        let left = silence.saturating_sub(self.presence.silence());
        self.presence.clock.sleep(left);
    }

    pub(super) fn is_closed(&self) -> bool {
        self.closed.load(Ordering::SeqCst)
    }

    pub(super) fn wait_for(&self, text: &str) {
        until(|| self.received.lock().unwrap().contains(text));
    }

    /// What a sender was sent that gets no control.
    pub(super) fn refusal(&self) -> String {
        until(|| self.is_closed());
        self.received.lock().unwrap().clone()
    }
}

/// Waits for a thread of a connection.
pub(super) fn until(wanted: impl Fn() -> bool) {
    while !wanted() {
        thread::yield_now();
    }
}
