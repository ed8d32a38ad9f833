//! A serial port.

use super::READ;
use serialport::{ErrorKind as PortErrorKind, SerialPort};
use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;

/// Baud rate of the boards of this project [1/s].
pub const BAUD: u32 = 1_000_000;

/// An open serial port; no other program can open it meanwhile.
pub struct SerialLine {
    port: Box<dyn SerialPort>,
}

/// Why a port cannot be opened.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PortError {
    /// The port does not exist.
    #[error("there is no port {port}; {}", available(.others))]
    Absent {
        /// The port asked for.
        port: String,
        /// The ports of this machine.
        others: Vec<String>,
    },
    /// Another program uses the port.
    #[error("port {0} is busy: close the program that uses it (a monitor, a terminal)")]
    Busy(String),
    /// The user has no permission for the port.
    #[error(
        "this user has no permission for port {0}; on Linux, join the group that owns it (often \
         `dialout`) and log in again"
    )]
    Denied(String),
    /// The port cannot be used for another reason.
    #[error("{port} does not work as a serial port: {error}")]
    Unusable {
        /// The port asked for.
        port: String,
        /// The system's message.
        error: String,
    },
}

fn available(ports: &[String]) -> String {
    if ports.is_empty() {
        "this machine has no serial port: plug the board in".into()
    } else {
        format!("this machine has {}", ports.join(", "))
    }
}

impl SerialLine {
    /// Opens a port at [`BAUD`], 8 bits, no parity, one stop bit.
    ///
    /// # Errors
    /// The port does not exist, is busy, needs a permission or is no serial port.
    pub fn open(port: &str) -> Result<Self, PortError> {
        serialport::new(port, BAUD)
            .timeout(READ)
            .open()
            .map(|port| Self { port })
            .map_err(|error| describe(port, &error))
    }
}

fn describe(port: &str, error: &serialport::Error) -> PortError {
    let exists = Path::new(port).exists();
    match error.kind() {
        PortErrorKind::Io(ErrorKind::PermissionDenied) if cfg!(windows) => {
            PortError::Busy(port.to_owned())
        }
        PortErrorKind::Io(ErrorKind::PermissionDenied) => PortError::Denied(port.to_owned()),
        // The library's error for a port that another program has locked.
        PortErrorKind::NoDevice if exists => PortError::Busy(port.to_owned()),
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
                "the port disappeared; check that the board is plugged in",
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
