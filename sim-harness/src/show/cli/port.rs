//! What the commands that talk to a controller share: its port, a log, Ctrl-C.

use super::failure::{Failure, refused};
use super::say::warn;
use crate::run::link::{Client, SerialLine, Tracer};
use fivebar_firmware::protocol::{Board, Identity, Reset};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Which controller.
#[derive(clap::Args)]
pub(super) struct PortArgs {
    /// The controller's serial port, such as /dev/ttyACM0 or COM3.
    #[arg(long)]
    port: String,
    /// Write down everything said on the port.
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
}

/// A client over a serial port.
pub(super) type PortClient = Client<Tracer<SerialLine, Box<dyn Write>>>;

impl PortArgs {
    /// Opens the port, says hello and tells who answers.
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
            "{}: {}, firmware {major}.{minor}.{patch}, last started {}",
            self.port,
            board(identity.board),
            cause(identity.reset)
        ));
        Ok((client, identity))
    }
}

fn board(board: Board) -> &'static str {
    match board {
        Board::Desktop => "a controller in a desktop's process",
        Board::Emulated => "an emulated board",
        Board::Stm32f405 => "an STM32F405",
    }
}

fn cause(reset: Reset) -> &'static str {
    match reset {
        Reset::Power => "by power or its reset pin",
        Reset::Software => "by its program or a debugger",
        Reset::Watchdog => "by its watchdog, which was not fed",
        Reset::Panic => "by a panic of its program",
        Reset::HardFault => "by a fault of its processor",
        Reset::BrownOut => "by a sag of its supply",
    }
}

/// True from the first Ctrl-C on.
pub(super) fn interrupted() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    ctrlc::set_handler(move || raised.store(true, Ordering::Relaxed))
        .map_err(|error| refused(format_args!("cannot listen for Ctrl-C: {error}")))?;
    Ok(flag)
}
