//! An emulated STM32F405 in a process of its own, its serial line a local TCP connection.

use super::READ;
use super::kept_child::KeptChild;
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

/// A running emulated board; it ends with this value, and with this process.
#[derive(Debug)]
pub struct Emulator {
    _process: KeptChild,
    line: TcpStream,
    /// The emulator's own command line.
    monitor: TcpStream,
}

/// Why no emulated board runs.
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    /// There is no image.
    #[error("there is no firmware image at {}; build it with scripts/firmware.sh", .0.display())]
    NoImage(PathBuf),
    /// There is no emulator.
    #[error(
        "there is no {QEMU} on this machine; install your system's package of that name \
         (Debian: apt-get install qemu-system-arm)"
    )]
    NoQemu,
    /// The emulator ended before it began.
    #[error("{QEMU} ended at once: {0}")]
    Ended(String),
    /// The emulator did not connect.
    #[error("{QEMU} did not connect within {} s", START.as_secs())]
    NoConnection,
    /// The machine refused something.
    #[error("cannot start {QEMU}: {0}")]
    Io(#[from] io::Error),
}

impl Emulator {
    /// The image of the emulated board, where `scripts/firmware.sh` leaves it.
    pub fn built_image(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../target/firmware/thumbv7em-none-eabihf/firmware")
            .join(name)
    }

    /// What is likely where a board with this image does not answer as this program does.
    pub fn suspicion(image: &Path) -> String {
        format!(
            "its image {} is likely older than this program: build it anew with \
             scripts/firmware.sh",
            image.display()
        )
    }

    /// Starts a board that runs `image`, one instruction per nanosecond of its time.
    ///
    /// # Errors
    /// No image, no emulator, or an emulator that does not start.
    pub fn start(image: &Path) -> Result<Self, EmulatorError> {
        Self::start_with(image, &[])
    }

    /// Starts a board whose memory holds these files from these addresses on, after the
    /// image has been loaded; at each reset they are there anew.
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
        let mut process = KeptChild::start(QEMU, &arguments).map_err(not_started)?;
        let line = connection(&serial, &mut process)?;
        line.set_read_timeout(Some(READ))?;
        let monitor = connection(&monitor, &mut process)?;
        Ok(Self {
            _process: process,
            line,
            monitor,
        })
    }

    /// Presses the board's reset button. It starts again soon after; what it was told
    /// before may or may not have been heard.
    ///
    /// # Errors
    /// The emulator has ended.
    pub fn reset(&mut self) -> io::Result<()> {
        self.monitor.write_all(b"system_reset\n")
    }
}

/// Waits for the emulator's connection, its end or its time to run out.
fn connection(listener: &TcpListener, process: &mut KeptChild) -> Result<TcpStream, EmulatorError> {
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
            Ok(Some((_, words))) => return Err(EmulatorError::Ended(words.trim().to_owned())),
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
            // What a read timeout is called differs from system to system.
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
    fn a_missing_image_is_refused_with_the_way_to_build_it() {
        let error = Emulator::start(Path::new("/nowhere/qemu")).expect_err("no such image");
        assert!(matches!(error, EmulatorError::NoImage(_)));
        assert!(error.to_string().contains("scripts/firmware.sh"), "{error}");
    }
}
