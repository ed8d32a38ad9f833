//! A sender's connection, over TCP or at the pseudo-terminal: how it asks for control, is read and
//! is written to.
//!
//! Each connection has a thread that reads and one that writes, so that neither a silent nor a
//! slow sender delays the controller's thread. Nothing is read before the slot has given the connection
//! control, and one connection has it at a time.

use super::options::BridgeError;
use super::protocol::{Gate, Input, RealTime};
use super::{network, terminal};
use crate::senders::Endpoints;
use fivebar_files::job::Dialect;
use fivebar_sim::clock::Clock;
use std::io::{self, ErrorKind};
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::{Duration, Instant};

/// Answers that may wait for a sender that does not read.
const ANSWERS: usize = 4096;
/// Lines and commands of senders that may wait for the controller's thread.
const EVENTS: usize = 1 << 14;
/// Reports that a sender may ask for until one is sent: more than senders ask for in ten seconds.
const MOST_REPORTS: u32 = 1000;
const FLOODS: &str = "the sender sends faster than it is served, and is disconnected";

/// What the connections send to the sender slot.
pub(super) enum Event {
    /// A sender asks for control.
    Asks(Visitor),
    /// The sender in control has sent this.
    Input(Arc<Presence>, Input),
}

/// A sender that waits for control.
pub(super) struct Visitor {
    outlet: Outlet,
    verdict: SyncSender<bool>,
}

impl Visitor {
    /// Gives it control; its connection is read from now on.
    pub(super) fn admit(self) -> Outlet {
        // It fails only if the connection's thread has ended.
        let _ = self.verdict.try_send(true);
        self.outlet
    }

    /// Sends the reason why it gets no control, and disconnects it.
    pub(super) fn refuse(self, why: &str) {
        self.outlet.send(why);
        self.outlet.end();
        let _ = self.verdict.try_send(false);
    }
}

/// What both ends of a connection know of it.
pub(super) struct Presence {
    /// Who it is: an address, or the terminal.
    pub(super) peer: String,
    /// The time of the connection, as of all that it waits for.
    pub(super) clock: Clock,
    begun: Instant,
    /// When the latest byte came [ms after `begun`].
    received: AtomicU64,
    /// Reports that the sender waits for. One answers all that were asked for meanwhile, as Grbl does.
    reports: AtomicU32,
    /// Why the connection has ended.
    ended: OnceLock<String>,
}

impl Presence {
    pub(super) fn new(peer: String, clock: &Clock) -> Arc<Self> {
        Arc::new(Self {
            peer,
            begun: clock.now(),
            clock: clock.clone(),
            received: AtomicU64::new(0),
            reports: AtomicU32::new(0),
            ended: OnceLock::new(),
        })
    }

    /// Time since the latest byte.
    pub(super) fn silence(&self) -> Duration {
        let received = Duration::from_millis(self.received.load(Ordering::SeqCst));
        self.clock.since(self.begun).saturating_sub(received)
    }

    /// Whether the sender has asked for a report since the last call.
    pub(super) fn takes_report(&self) -> bool {
        self.reports.swap(0, Ordering::SeqCst) > 0
    }

    /// Why the connection has ended, if it has.
    pub(super) fn ended(&self) -> Option<&str> {
        self.ended.get().map(String::as_str)
    }

    fn receive(&self) {
        let time = self.clock.since(self.begun).as_millis() as u64;
        self.received.store(time, Ordering::SeqCst);
    }
}

/// The output to a sender.
pub(super) struct Outlet {
    pub(super) presence: Arc<Presence>,
    /// A text to send; none: disconnect the sender.
    answers: SyncSender<Option<String>>,
    close: Arc<dyn Fn() + Send + Sync>,
}

impl Outlet {
    /// Starts a thread that writes answers until one cannot be written, the connection has ended, or
    /// the slot has dropped the connection.
    pub(super) fn start(
        presence: Arc<Presence>,
        mut write: impl FnMut(&str) -> bool + Send + 'static,
        close: impl Fn() + Send + Sync + 'static,
    ) -> Self {
        let (answers, texts) = mpsc::sync_channel::<Option<String>>(ANSWERS);
        let close: Arc<dyn Fn() + Send + Sync> = Arc::new(close);
        let (ends, line) = (Arc::clone(&close), Arc::clone(&presence));
        thread::spawn(move || {
            while let Ok(text) = texts.recv() {
                match text {
                    Some(text) if line.ended().is_none() && write(&text) => {}
                    Some(_) => return,
                    None => return ends(),
                }
            }
        });
        Self {
            presence,
            answers,
            close,
        }
    }

    /// Sends a text. A sender that has left too many answers unread is disconnected.
    pub(super) fn send(&self, text: &str) {
        if !text.is_empty() && self.answers.try_send(Some(text.into())).is_err() {
            self.close();
        }
    }

    /// Disconnects the sender after what was sent to it.
    pub(super) fn end(&self) {
        if self.answers.try_send(None).is_err() {
            self.close();
        }
    }

    /// Disconnects the sender.
    pub(super) fn close(&self) {
        (self.close)();
    }
}

/// What connections and the sender slot share, past the queue of events.
#[derive(Default)]
pub(super) struct Shared {
    /// A stop with the bridges off was asked for. It is in the queue of events too, where it ends
    /// what was sent before it.
    stops: AtomicBool,
    /// The stop is to be latched also if the bridges are off.
    latches: AtomicBool,
}

impl Shared {
    /// Asks for a stop with the bridges off, which is to be latched if they are off already.
    pub(super) fn emergency_stop(&self) {
        self.latches.store(true, Ordering::SeqCst);
        self.reset();
    }

    /// Asks for the bridges to be off.
    fn reset(&self) {
        self.stops.store(true, Ordering::SeqCst);
    }

    /// The stop that was asked for, if there is one: whether it is to be latched in any case.
    pub(super) fn take_stop(&self) -> Option<bool> {
        let stops = self.stops.swap(false, Ordering::SeqCst);
        stops.then(|| self.latches.swap(false, Ordering::SeqCst))
    }
}

/// What a connection needs to serve a sender.
#[derive(Clone)]
pub(super) struct Desk {
    shared: Arc<Shared>,
    events: SyncSender<Event>,
    dialect: Option<Dialect>,
    clock: Clock,
}

impl Desk {
    /// A sender that has connected.
    pub(super) fn presence(&self, peer: impl Into<String>) -> Arc<Presence> {
        Presence::new(peer.into(), &self.clock)
    }

    /// Asks for control; returns whether it was given. Waits until the slot has answered.
    pub(super) fn ask(&self, outlet: Outlet) -> bool {
        let (verdict, given) = mpsc::sync_channel(1);
        let visitor = Visitor { outlet, verdict };
        let asked = self.events.try_send(Event::Asks(visitor));
        asked.is_ok() && given.recv() == Ok(true)
    }

    /// A gate for bytes that any program of the network may send.
    pub(super) fn guarded_gate(&self) -> Gate {
        Gate::guarded(self.dialect)
    }

    /// A gate for bytes of programs that may open the terminal, and of consoles.
    pub(super) fn open_gate(&self) -> Gate {
        Gate::open(self.dialect)
    }

    /// Passes on what `read` gives until it fails or the gate closes.
    pub(super) fn pass_on(
        &self,
        presence: &Arc<Presence>,
        gate: Gate,
        read: impl FnMut(&mut [u8]) -> io::Result<usize>,
    ) {
        let why = self.why_it_ends(presence, gate, read);
        // It is set here only.
        let _ = presence.ended.set(why);
    }

    fn why_it_ends(
        &self,
        presence: &Arc<Presence>,
        mut gate: Gate,
        mut read: impl FnMut(&mut [u8]) -> io::Result<usize>,
    ) -> String {
        let mut bytes = [0; 1024];
        loop {
            let count = match read(&mut bytes) {
                Ok(0) => return "the sender has closed the connection".into(),
                Ok(count) => count,
                Err(error)
                    if matches!(
                        error.kind(),
                        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
                    ) =>
                {
                    continue;
                }
                Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                    return "the sender has closed the connection".into();
                }
                Err(error) => return format!("the connection to the sender failed: {error}"),
            };
            presence.receive();
            for &byte in &bytes[..count] {
                let inputs = match gate.feed(byte) {
                    Ok(inputs) => inputs,
                    Err(why) => return format!("{} is disconnected: {why}", presence.peer),
                };
                for input in inputs {
                    match input {
                        Input::RealTime(RealTime::Report) => {
                            if presence.reports.fetch_add(1, Ordering::SeqCst) > MOST_REPORTS {
                                return FLOODS.into();
                            }
                            continue;
                        }
                        Input::RealTime(RealTime::Reset) => self.shared.reset(),
                        Input::RealTime(RealTime::Emergency) => self.shared.emergency_stop(),
                        Input::RealTime(_) | Input::Line(_) => {}
                    }
                    let event = Event::Input(Arc::clone(presence), input);
                    if self.events.try_send(event).is_err() {
                        return FLOODS.into();
                    }
                }
            }
        }
    }
}

/// The slot's end of all connections.
pub(super) struct Connections {
    pub(super) events: Receiver<Event>,
    pub(super) shared: Arc<Shared>,
}

/// The address and the terminal where senders connect, each if it is there.
pub(super) struct Listening {
    address: Option<SocketAddr>,
    terminal: Option<String>,
}

impl Listening {
    /// The same with the place where the controller runs.
    pub(super) fn endpoints(self, place: &str) -> Endpoints {
        Endpoints {
            address: self.address,
            terminal: self.terminal,
            place: place.into(),
        }
    }
}

/// Where senders ask for control, and the slot's end of their connections.
pub(super) fn desk(dialect: Option<Dialect>, clock: Clock) -> (Desk, Connections) {
    let (sender, events) = mpsc::sync_channel(EVENTS);
    let shared = Arc::<Shared>::default();
    let desk = Desk {
        shared: Arc::clone(&shared),
        events: sender,
        dialect,
        clock,
    };
    (desk, Connections { events, shared })
}

/// Starts the threads that accept senders: at a pseudo-terminal if this system has one, and over
/// TCP if an address is given.
pub(super) fn listen(address: Option<SocketAddr>, desk: &Desk) -> Result<Listening, BridgeError> {
    let address = address.map(|address| network::listen(address, desk.clone()));
    let address = address.transpose()?;
    let terminal = terminal::open(desk.clone()).map_err(BridgeError::Terminal)?;
    if address.is_none() && terminal.is_none() {
        return Err(BridgeError::NoTerminal);
    }
    Ok(Listening { address, terminal })
}
