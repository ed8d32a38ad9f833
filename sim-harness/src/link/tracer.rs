//! A log of all frames on a connection.

use super::frames::Frames;
use fivebar_firmware::protocol::{ControllerMessage, Decoder, HostMessage, Message};
use std::io::{self, Read, Write};

/// A connection `L` whose frames are written to `log`, one frame per line of text: `>` from
/// the host, `<` from the controller, then the message, or the bytes if there is none.
pub struct Tracer<L, W> {
    line: L,
    log: W,
    sent: Frames,
    received: Frames,
}

impl<L, W: Write> Tracer<L, W> {
    /// Logs the frames of `line`.
    pub fn new(line: L, log: W) -> Self {
        Self {
            line,
            log,
            sent: Frames::default(),
            received: Frames::default(),
        }
    }
}

/// One line of text for a frame.
fn describe<M: Message + std::fmt::Debug>(frame: &[u8]) -> String {
    let mut decoder = Decoder::<M>::new();
    let message = frame.iter().find_map(|&byte| decoder.feed(byte));
    match message {
        Some(Ok(message)) => format!("{message:?}"),
        Some(Err(error)) => format!("{error}: {frame:02x?}"),
        None => format!("no frame: {frame:02x?}"),
    }
}

impl<L: Read, W: Write> Read for Tracer<L, W> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.line.read(bytes)?;
        for &byte in bytes.iter().take(count) {
            if let Some(frame) = self.received.feed(byte) {
                writeln!(self.log, "< {}", describe::<ControllerMessage>(&frame))?;
            }
        }
        Ok(count)
    }
}

impl<L: Write, W: Write> Write for Tracer<L, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.line.write(bytes)?;
        for &byte in bytes.iter().take(count) {
            if let Some(frame) = self.sent.feed(byte) {
                writeln!(self.log, "> {}", describe::<HostMessage>(&frame))?;
            }
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.line.flush()
    }
}
