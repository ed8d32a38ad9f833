//! The line to the controller, which a stop interrupts.

use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A line to a controller.
pub(super) trait Line: Read + Write + Send {}
impl<T: Read + Write + Send> Line for T {}

/// A line on which every exchange fails while a flag is set: a step that waits for anything ends then.
pub(super) struct Stoppable {
    line: Box<dyn Line>,
    stop: Arc<AtomicBool>,
}

impl Stoppable {
    pub(super) fn new(line: Box<dyn Line>, stop: Arc<AtomicBool>) -> Self {
        Self { line, stop }
    }

    fn check(&self) -> io::Result<()> {
        if self.stop.load(Ordering::Acquire) {
            return Err(io::Error::other("stopped by the user"));
        }
        Ok(())
    }
}

impl Read for Stoppable {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.check()?;
        self.line.read(buffer)
    }
}

impl Write for Stoppable {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.check()?;
        self.line.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.line.flush()
    }
}
