//! The common part of commands with a controller on a port: the port, a log, Ctrl-C.

use super::failure::{Failure, refused};
use super::say::warn;
use fivebar_firmware::protocol::{Identity, Reset};
use fivebar_sim::boards::Facts;
use fivebar_sim::link::{Client, SerialLine, Tracer};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The options for the controller's port.
#[derive(clap::Args)]
pub(super) struct PortArgs {
    /// The controller's serial port, such as /dev/ttyACM0 or COM3.
    #[arg(long)]
    port: String,
    /// Write a log of all frames on the port.
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
}

/// A client over a serial port.
pub(super) type PortClient = Client<Tracer<SerialLine, Box<dyn Write>>>;

impl PortArgs {
    /// Opens the port and a session, and prints which controller replied.
    pub(super) fn open(&self) -> Result<(PortClient, Identity), Failure> {
        let log: Box<dyn Write> = match &self.trace {
            None => Box::new(io::sink()),
            Some(path) => Box::new(BufWriter::new(File::create(path).map_err(|error| {
                refused(format_args!("cannot write {}: {error}", path.display()))
            })?)),
        };
        let line = SerialLine::open(&self.port).map_err(refused)?;
        let (client, identity) = Client::open(Tracer::new(line, log))
            .map_err(|error| refused(format_args!("{}: {error}", self.port)))?;
        let [major, minor, patch] = identity.firmware;
        warn(format_args!(
            "{}: {}, firmware {major}.{minor}.{patch}, last reset {}",
            self.port,
            Facts::of(identity.board).words(),
            cause(identity.reset)
        ));
        Ok((client, identity))
    }
}

fn cause(reset: Reset) -> &'static str {
    match reset {
        Reset::Power => "by power-up",
        Reset::Software => "by software or a debugger",
        Reset::Watchdog => "by the watchdog",
        Reset::Panic => "by a panic of the firmware",
        Reset::HardFault => "by a hard fault of the processor",
        Reset::BrownOut => "by a brown-out of the supply",
        Reset::Pin => "by the reset pin",
        Reset::Unknown => "for an unknown reason",
    }
}

/// The signals that end a program, other than those of `ctrlc`: also those that write a core, and those that mean
/// nothing to this program. Those of a fault of the processor cannot be handled: after them, as after `kill -9`, the
/// controller's command timeout stops the arm.
#[cfg(unix)]
const OTHER_SIGNALS: [i32; 10] = {
    use signal_hook::consts::*;
    [
        SIGQUIT, SIGABRT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGIO, SIGXCPU, SIGXFSZ,
    ]
};

/// A flag that becomes true at the first signal to end: Ctrl-C, or the system's, as from `kill`, from
/// a service manager, or from a terminal that closes. Another signal changes nothing: the arm comes to
/// rest already.
pub(super) fn interrupted() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    let mut is_first = true;
    ctrlc::set_handler(move || {
        if std::mem::take(&mut is_first) {
            raised.store(true, Ordering::Release);
        }
    })
    .map_err(|error| refused(format_args!("cannot handle Ctrl-C: {error}")))?;
    #[cfg(unix)]
    for signal in OTHER_SIGNALS {
        let handled = signal_hook::flag::register(signal, Arc::clone(&flag));
        handled.map_err(|error| refused(format_args!("cannot handle signal {signal}: {error}")))?;
    }
    Ok(flag)
}
