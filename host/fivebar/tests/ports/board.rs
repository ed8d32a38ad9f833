//! Simulated boards at the far end of a serial port, and the program at the near end.

use fivebar_firmware::Status;
use fivebar_sim::link::Loopback;
use fivebar_testkit::{Running, program};
use serialport::{SerialPort, TTYPort};
use std::io::{Read, Write};
use std::process::{Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// Reads without data during which the board's time advances. They take about 50 ms, so that a
/// busy machine does not look like a silent host.
const SILENT_READS: u32 = 5;

/// The controller's latest status; none of a silent board.
#[derive(Default)]
struct Watched {
    status: Mutex<Option<Status>>,
    changed: Condvar,
}

/// A board at the far end of a pseudo-terminal.
pub(crate) struct Board {
    pub(crate) port: String,
    /// Whether its time advances whatever its host does.
    pub(crate) waits_for_nobody: Arc<AtomicBool>,
    status: Arc<Watched>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Board {
    /// A board with this controller, or a silent one.
    pub(crate) fn start(controller: Option<Loopback>) -> Self {
        let (mut far, near) = TTYPort::pair().expect("a pseudo-terminal opens");
        far.set_timeout(Duration::from_millis(5))
            .expect("the timeout can be set");
        let port = near.name().expect("the port has a name");
        let ends = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&ends);
        let waits_for_nobody = Arc::new(AtomicBool::new(false));
        let goes_on = Arc::clone(&waits_for_nobody);
        let status = Arc::new(Watched::default());
        let shown = Arc::clone(&status);
        let thread = std::thread::spawn(move || {
            // The near end stays open; otherwise reads of the far end fail before the program
            // opens the port.
            let _near = near;
            let mut controller = controller;
            let mut silence = 0;
            while !ended.load(Ordering::Relaxed) {
                let mut bytes = [0; 512];
                let count = far.read(&mut bytes).unwrap_or(0);
                let Some(controller) = &mut controller else {
                    continue;
                };
                silence = if count > 0 { 0 } else { silence + 1 };
                controller
                    .write_all(&bytes[..count])
                    .expect("the loopback link works");
                if (silence < SILENT_READS || goes_on.load(Ordering::Relaxed))
                    && let Ok(count) = controller.read(&mut bytes)
                {
                    // The write fails if the program has ended.
                    let _ = far.write_all(&bytes[..count]);
                }
                *shown.status.lock().expect("no panic") = Some(controller.status());
                shown.changed.notify_all();
            }
        });
        Self {
            port,
            waits_for_nobody,
            status,
            ends,
            thread: Some(thread),
        }
    }

    /// Waits until the status is as wanted, for as long as the board's thread and its host need.
    pub(crate) fn until(&self, wanted: impl Fn(&Status) -> bool) -> Status {
        let mut status = self.status.status.lock().expect("no panic");
        loop {
            if let Some(status) = status.as_ref().filter(|status| wanted(status)) {
                return *status;
            }
            status = self.status.changed.wait(status).expect("no panic");
        }
    }

    /// Starts `fivebar` on the board's port.
    pub(crate) fn fivebar(&self, arguments: &[&str]) -> Running {
        fivebar(&[arguments, &["--port", &self.port]].concat())
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().expect("the board did not panic");
        }
    }
}

/// Starts `fivebar`.
pub(crate) fn fivebar(arguments: &[&str]) -> Running {
    Running::start(
        program(env!("CARGO_BIN_EXE_fivebar"))
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped()),
    )
}

/// The exit status, standard output and standard error.
pub(crate) fn end(child: Running) -> (Option<i32>, String, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = child
        .into_child()
        .wait_with_output()
        .expect("the program ends");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8 text");
    (status.code(), text(stdout), text(stderr))
}
