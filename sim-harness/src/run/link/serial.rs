//! A serial port.

use super::READ;
use serialport::{ErrorKind as PortErrorKind, SerialPort};
use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;

/// Symbols per second of the boards here.
pub const BAUD: u32 = 1_000_000;

/// An open serial port, ours alone.
pub struct SerialLine {
    port: Box<dyn SerialPort>,
}

/// Why a port is not open.
#[derive(Debug, thiserror::Error)]
pub enum PortError {
    /// No such port.
    #[error("there is no port {port}; {}", what_there_is(.others))]
    Absent {
        /// The port asked for.
        port: String,
        /// The ports there are.
        others: Vec<String>,
    },
    /// Someone else has it.
    #[error("port {0} is busy: close the program that uses it (a monitor, a terminal)")]
    Busy(String),
    /// This user may not use it.
    #[error(
        "port {0} refuses this user; on Linux, join the group that owns it (often `dialout`) \
         and log in anew"
    )]
    Denied(String),
    /// It is something else.
    #[error("{port} does not work as a serial port: {error}")]
    Unusable {
        /// The port asked for.
        port: String,
        /// What the system says.
        error: String,
    },
}

fn what_there_is(ports: &[String]) -> String {
    if ports.is_empty() {
        "this machine has none: plug the board in".into()
    } else {
        format!("this machine has {}", ports.join(", "))
    }
}

impl SerialLine {
    /// Opens a port at [`BAUD`], 8 bits, no parity, one stop bit.
    ///
    /// # Errors
    /// An absent, busy or refused port, or none at all.
    pub fn open(port: &str) -> Result<Self, PortError> {
        serialport::new(port, BAUD)
            .timeout(READ)
            .open()
            .map(|port| Self { port })
            .map_err(|error| describe(port, &error))
    }
}

fn describe(port: &str, error: &serialport::Error) -> PortError {
    let is_there = Path::new(port).exists();
    match error.kind() {
        PortErrorKind::Io(ErrorKind::PermissionDenied) if cfg!(windows) => {
            PortError::Busy(port.to_owned())
        }
        PortErrorKind::Io(ErrorKind::PermissionDenied) => PortError::Denied(port.to_owned()),
        // What the library says of a port that another program has locked.
        PortErrorKind::NoDevice if is_there => PortError::Busy(port.to_owned()),
        PortErrorKind::NoDevice | PortErrorKind::Io(ErrorKind::NotFound) => PortError::Absent {
            port: port.to_owned(),
            others: serialport::available_ports()
                .unwrap_or_default()
                .into_iter()
                .map(|port| port.port_name)
                .collect(),
        },
        _ => PortError::Unusable {
            port: port.to_owned(),
            error: error.to_string(),
        },
    }
}

impl Read for SerialLine {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self.port.read(bytes) {
            Ok(0) => Err(io::Error::new(
                ErrorKind::ConnectionAborted,
                "the port is gone; was the board unplugged?",
            )),
            other => other,
        }
    }
}

impl Write for SerialLine {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.port.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.port.flush()
    }
}
