//! An emulated STM32F405 in a process of its own, its serial line a local TCP connection.

use super::READ;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The emulator's program.
const QEMU: &str = "qemu-system-arm";
/// How long the emulator may take to start.
const START: Duration = Duration::from_secs(10);

/// A running emulated board; it ends with this value.
#[derive(Debug)]
pub struct Emulator {
    process: Child,
    line: TcpStream,
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

    /// Starts a board that runs `image`, one instruction per nanosecond of its time.
    ///
    /// # Errors
    /// No image, no emulator, or an emulator that does not start.
    pub fn start(image: &Path) -> Result<Self, EmulatorError> {
        if !image.is_file() {
            return Err(EmulatorError::NoImage(image.to_owned()));
        }
        let listener = TcpListener::bind("127.0.0.1:0")?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let mut process = Command::new(QEMU)
            .args(["-machine", "netduinoplus2", "-icount", "shift=0"])
            .args(["-display", "none", "-monitor", "none"])
            .args(["-serial", &format!("tcp:{address},nodelay=on")])
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| match error.kind() {
                ErrorKind::NotFound => EmulatorError::NoQemu,
                _ => EmulatorError::Io(error),
            })?;
        match connection(&listener, &mut process) {
            Ok(line) => Ok(Self { process, line }),
            Err(error) => {
                end(&mut process);
                Err(error)
            }
        }
    }
}

/// Waits for the emulator's connection, its end or its time to run out.
fn connection(listener: &TcpListener, process: &mut Child) -> Result<TcpStream, EmulatorError> {
    let deadline = Instant::now() + START;
    loop {
        match listener.accept() {
            Ok((line, _)) => {
                line.set_nonblocking(false)?;
                line.set_nodelay(true)?;
                line.set_read_timeout(Some(READ))?;
                return Ok(line);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => return Err(error.into()),
        }
        if process.try_wait()?.is_some() {
            let mut words = String::new();
            if let Some(stderr) = &mut process.stderr {
                stderr.read_to_string(&mut words)?;
            }
            return Err(EmulatorError::Ended(words.trim().to_owned()));
        }
        if Instant::now() > deadline {
            return Err(EmulatorError::NoConnection);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn end(process: &mut Child) {
    // Either fails only if the process is gone already, which is what is wanted.
    let _ = process.kill();
    let _ = process.wait();
}

impl Drop for Emulator {
    fn drop(&mut self) {
        end(&mut self.process);
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
