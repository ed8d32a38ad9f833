//! The host's end of the serial line. Time passes in the chip while the host waits.

use crate::chip::Chip;
use crate::time::{MICROSECOND, Time};
use fivebar::run::link::READ;
use std::io::{self, ErrorKind, Read, Write};

/// The host looks for bytes so often.
const SLICE: Time = 50 * MICROSECOND;

/// A serial line to a chip.
pub struct HostLine {
    /// The chip.
    pub chip: Chip,
}

impl Read for HostLine {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let end = self.chip.now() + READ.as_micros() as Time * MICROSECOND;
        let mut received = self.chip.receive(bytes.len());
        while received.is_empty() {
            if self.chip.now() >= end {
                return Err(ErrorKind::TimedOut.into());
            }
            self.chip.run(SLICE).map_err(io::Error::other)?;
            received = self.chip.receive(bytes.len());
        }
        bytes[..received.len()].copy_from_slice(&received);
        Ok(received.len())
    }
}

impl Write for HostLine {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.chip.send(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
