//! Senders' connections: over TCP and at a pseudo-terminal.
//!
//! Each connection has a thread that reads and one that writes, so that neither a silent nor a
//! slow sender delays the machine. One connection is in control at a time.

use super::BridgeError;
use super::protocol::{Input, RealTime, Splitter};
use crate::input::job::Dialect;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::thread;
use std::time::{Duration, Instant};

/// Answers that may wait for a sender that does not read.
const ANSWERS: usize = 4096;
/// Longest wait for a sender that does not read.
const LONGEST_WRITE: Duration = Duration::from_secs(10);
/// Time between two looks at a pseudo-terminal that no program has open.
#[cfg(unix)]
const LOOK: Duration = Duration::from_millis(20);
const BUSY: &str = "[MSG:another sender is in control: disconnect it first]\nerror:9\n";

/// What the connections tell the machine.
pub(super) enum Event {
    /// A sender is in control.
    Opened(Outlet),
    /// It has sent this.
    Input(Input),
    /// It is lost, and why.
    Closed(String),
}

/// The way to a sender.
pub(super) struct Outlet {
    /// A text to send; none: disconnect the sender.
    answers: SyncSender<Option<String>>,
    close: Arc<dyn Fn() + Send + Sync>,
}

impl Outlet {
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

/// What connections and machine share, past the queue of events.
#[derive(Default)]
pub(super) struct Shared {
    /// An emergency stop was asked for. It is in the queue of events too, where it ends what was
    /// sent before it.
    pub(super) emergency: AtomicBool,
    /// A sender is in control.
    pub(super) taken: AtomicBool,
}

impl Shared {
    fn take(&self) -> bool {
        !self.taken.swap(true, Ordering::SeqCst)
    }
}

/// What a connection needs to serve a sender.
#[derive(Clone)]
struct Desk {
    shared: Arc<Shared>,
    events: Sender<Event>,
    dialect: Option<Dialect>,
}

impl Desk {
    /// Passes on what `read` gives until it fails.
    fn pass_on(&self, mut read: impl FnMut(&mut [u8]) -> io::Result<usize>) -> String {
        let mut splitter = Splitter::new(self.dialect);
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
            for &byte in &bytes[..count] {
                for input in splitter.feed(byte) {
                    if input == Input::Web {
                        return "a web browser asked, which is no sender".into();
                    }
                    if input == Input::RealTime(RealTime::Emergency) {
                        self.shared.emergency.store(true, Ordering::SeqCst);
                    }
                    if self.events.send(Event::Input(input)).is_err() {
                        return "the program ends".into();
                    }
                }
            }
        }
    }
}

/// Starts the threads that accept senders. Returns the address, the name of the
/// pseudo-terminal if this system has one, and the events of the sender in control.
pub(super) fn listen(
    address: SocketAddr,
    dialect: Option<Dialect>,
    shared: &Arc<Shared>,
) -> Result<(SocketAddr, Option<String>, Receiver<Event>), BridgeError> {
    let listener = TcpListener::bind(address);
    let listener = listener.map_err(|source| BridgeError::Listen { address, source })?;
    let bound = listener.local_addr().map_err(BridgeError::Terminal)?;
    let (events, receiver) = mpsc::channel();
    let desk = Desk {
        shared: Arc::clone(shared),
        events,
        dialect,
    };
    let terminal = terminal(desk.clone()).map_err(BridgeError::Terminal)?;
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let desk = desk.clone();
            thread::spawn(move || serve(&desk, stream));
        }
    });
    Ok((bound, terminal, receiver))
}

fn serve(desk: &Desk, mut stream: TcpStream) {
    let _ = stream.set_nodelay(true);
    let _ = stream.set_write_timeout(Some(LONGEST_WRITE));
    if !desk.shared.take() {
        let _ = stream.write_all(BUSY.as_bytes());
        return;
    }
    let (Ok(mut out), Ok(closer)) = (stream.try_clone(), stream.try_clone()) else {
        desk.shared.taken.store(false, Ordering::SeqCst);
        return;
    };
    let outlet = outlet(
        move |text| out.write_all(text.as_bytes()).is_ok(),
        move || {
            let _ = closer.shutdown(Shutdown::Both);
        },
    );
    let _ = desk.events.send(Event::Opened(outlet));
    let why = desk.pass_on(|bytes| stream.read(bytes));
    let _ = stream.shutdown(Shutdown::Both);
    let _ = desk.events.send(Event::Closed(why));
}

/// A thread that writes answers until one cannot be written or the machine has dropped the way
/// to it.
fn outlet(
    mut write: impl FnMut(&str) -> bool + Send + 'static,
    close: impl Fn() + Send + Sync + 'static,
) -> Outlet {
    let (answers, texts) = mpsc::sync_channel::<Option<String>>(ANSWERS);
    let close: Arc<dyn Fn() + Send + Sync> = Arc::new(close);
    let ends = Arc::clone(&close);
    thread::spawn(move || {
        while let Ok(text) = texts.recv() {
            match text {
                Some(text) if write(&text) => {}
                Some(_) => return,
                None => return ends(),
            }
        }
    });
    Outlet { answers, close }
}

#[cfg(not(unix))]
fn terminal(_: Desk) -> io::Result<Option<String>> {
    Ok(None)
}

/// Opens a pseudo-terminal. A program that opens it is a sender until it closes it.
#[cfg(unix)]
fn terminal(desk: Desk) -> io::Result<Option<String>> {
    use serialport::{SerialPort as _, TTYPort};

    let (mut master, slave) = TTYPort::pair()?;
    let name = slave.name();
    let path = name.clone();
    drop(slave);
    let mut out = master.try_clone_native()?;
    master.set_timeout(LOOK)?;
    out.set_timeout(LOOK)?;
    thread::spawn(move || {
        loop {
            // While no program has the terminal open, reading fails at once.
            let mut first = [0; 1024];
            let (mut count, is_open) = match master.read(&mut first) {
                Ok(count) => (count, true),
                Err(error) => (0, error.kind() == ErrorKind::TimedOut),
            };
            if !is_open {
                thread::sleep(LOOK);
                continue;
            }
            make_raw(path.as_deref());
            if !desk.shared.take() {
                let _ = out.write_all(BUSY.as_bytes());
                while !matches!(master.read(&mut first), Err(error) if error.kind() != ErrorKind::TimedOut)
                {
                }
                continue;
            }
            let Ok(mut writer) = out.try_clone_native() else {
                desk.shared.taken.store(false, Ordering::SeqCst);
                continue;
            };
            let closed = Arc::new(AtomicBool::new(false));
            let close = Arc::clone(&closed);
            let outlet = outlet(
                move |text| write_slowly(&mut writer, text.as_bytes()).is_ok(),
                move || close.store(true, Ordering::SeqCst),
            );
            let _ = desk.events.send(Event::Opened(outlet));
            let why = desk.pass_on(|bytes| {
                if closed.load(Ordering::SeqCst) {
                    return Err(ErrorKind::ConnectionAborted.into());
                }
                if count > 0 {
                    let taken = std::mem::take(&mut count);
                    bytes[..taken].copy_from_slice(&first[..taken]);
                    return Ok(taken);
                }
                master.read(bytes)
            });
            if desk.events.send(Event::Closed(why)).is_err() {
                return;
            }
        }
    });
    Ok(name)
}

/// Sets the terminal to pass bytes unchanged, for programs that open it like a file. A program
/// that has it for itself has done so.
#[cfg(unix)]
fn make_raw(path: Option<&str>) {
    use serialport::TTYPort;

    let builder = path.map(|path| serialport::new(path, 0));
    drop(builder.map(|builder| TTYPort::open(&builder.exclusive(false))));
}

/// Writes to a terminal whose reader may be slow.
#[cfg(unix)]
fn write_slowly(out: &mut impl Write, mut bytes: &[u8]) -> io::Result<()> {
    let deadline = Instant::now() + LONGEST_WRITE;
    while !bytes.is_empty() {
        match out.write(bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(error) if error.kind() == ErrorKind::TimedOut && Instant::now() < deadline => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
