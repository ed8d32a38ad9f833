//! An emulated STM32F405 in its own process. A local TCP connection is its serial line.

use super::READ;
use super::supervised_child::SupervisedChild;
use crate::boards;
use std::ffi::OsString;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The emulator's program.
const QEMU: &str = "qemu-system-arm";
/// What is emulated: one instruction takes one nanosecond.
const BOARD: [&str; 6] = [
    "-machine",
    "netduinoplus2",
    "-icount",
    "shift=0",
    "-display",
    "none",
];
/// How long the emulator may take to start.
const START: Duration = Duration::from_secs(10);

/// A running emulated board. It ends when this value is dropped or this process ends.
#[derive(Debug)]
pub struct Emulator {
    _process: SupervisedChild,
    line: TcpStream,
    /// The emulator's control connection.
    monitor: TcpStream,
}

/// Why an emulated board does not run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EmulatorError {
    /// The image does not exist.
    #[error("there is no firmware image at {}; build it with scripts/firmware.sh", .0.display())]
    NoImage(PathBuf),
    /// The emulator is not installed.
    #[error(
        "{QEMU} is not installed; install your system's package of that name \
         (Debian: apt-get install qemu-system-arm)"
    )]
    NoQemu,
    /// The emulator ended during its start.
    #[error("{QEMU} ended at once: {0}")]
    Ended(String),
    /// The emulator did not connect.
    #[error("{QEMU} did not connect within {} s", START.as_secs())]
    NoConnection,
    /// The operating system reported an error.
    #[error("cannot start {QEMU}: {0}")]
    Io(#[from] io::Error),
}

impl Emulator {
    /// The path at which `scripts/firmware.sh` leaves the image `name`.
    pub fn built_image(name: &str) -> PathBuf {
        boards::EMULATED.built(name)
    }

    /// The likely cause if a board with this image gives other outputs than this program,
    /// or no reply.
    pub fn likely_cause(image: &Path) -> String {
        format!(
            "its image {} is likely older than this program: build it again with \
             scripts/firmware.sh",
            image.display()
        )
    }

    /// Starts a board that runs `image`; each instruction takes 1 ns of emulated time.
    ///
    /// # Errors
    /// The image does not exist, or the emulator is not installed or does not start.
    pub fn start(image: &Path) -> Result<Self, EmulatorError> {
        Self::start_with(image, &[])
    }

    /// Starts a board with these files in its memory at these addresses, on top of the
    /// image. Each reset loads them again.
    ///
    /// # Errors
    /// As [`Emulator::start`].
    pub fn start_with(image: &Path, memory: &[(u32, &Path)]) -> Result<Self, EmulatorError> {
        if !image.is_file() {
            return Err(EmulatorError::NoImage(image.to_owned()));
        }
        let serial = TcpListener::bind("127.0.0.1:0")?;
        let monitor = TcpListener::bind("127.0.0.1:0")?;
        let mut arguments: Vec<OsString> = BOARD.iter().map(OsString::from).collect();
        for (option, listener) in [("-serial", &serial), ("-monitor", &monitor)] {
            let address = listener.local_addr()?;
            arguments.push(option.into());
            arguments.push(format!("tcp:{address},nodelay=on").into());
        }
        arguments.extend(["-kernel".into(), image.into()]);
        for (address, file) in memory {
            let mut loader = OsString::from(format!("loader,addr={address:#x},force-raw=on,file="));
            loader.push(file);
            arguments.extend(["-device".into(), loader]);
        }
        let mut process = SupervisedChild::start(QEMU, &arguments).map_err(not_started)?;
        let line = connection(&serial, &mut process)?;
        line.set_read_timeout(Some(READ))?;
        let monitor = connection(&monitor, &mut process)?;
        Ok(Self {
            _process: process,
            line,
            monitor,
        })
    }

    /// Resets the board. It restarts soon after; bytes sent shortly before may be lost.
    ///
    /// # Errors
    /// The emulator has ended.
    pub fn reset(&mut self) -> io::Result<()> {
        self.monitor.write_all(b"system_reset\n")
    }
}

/// Waits for the emulator to connect, to end, or to use up its time.
fn connection(
    listener: &TcpListener,
    process: &mut SupervisedChild,
) -> Result<TcpStream, EmulatorError> {
    listener.set_nonblocking(true)?;
    let deadline = Instant::now() + START;
    loop {
        match listener.accept() {
            Ok((line, _)) => {
                line.set_nonblocking(false)?;
                line.set_nodelay(true)?;
                return Ok(line);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        match process.end() {
            Ok(None) => {}
            Ok(Some((_, text))) => return Err(EmulatorError::Ended(text.trim().to_owned())),
            Err(error) => return Err(not_started(error)),
        }
        if Instant::now() > deadline {
            return Err(EmulatorError::NoConnection);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn not_started(error: io::Error) -> EmulatorError {
    match error.kind() {
        ErrorKind::NotFound => EmulatorError::NoQemu,
        _ => EmulatorError::Io(error),
    }
}

impl Read for Emulator {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self.line.read(bytes) {
            Ok(0) => Err(io::Error::new(
                ErrorKind::ConnectionAborted,
                format!("{QEMU} ended"),
            )),
            // Some systems report a read timeout as `WouldBlock`.
            Err(error) if error.kind() == ErrorKind::WouldBlock => Err(ErrorKind::TimedOut.into()),
            other => other,
        }
    }
}

impl Write for Emulator {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.line.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.line.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::{Emulator, EmulatorError};
    use std::path::Path;

    #[test]
    fn the_error_for_a_missing_image_says_how_to_build_it() {
        let error = Emulator::start(Path::new("/nowhere/qemu")).expect_err("no such image");
        assert!(matches!(error, EmulatorError::NoImage(_)));
        assert!(error.to_string().contains("scripts/firmware.sh"), "{error}");
    }
}
