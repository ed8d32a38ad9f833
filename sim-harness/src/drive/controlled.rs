//! A controller whose time passes.

use crate::link::{Client, LinkError};
use fivebar_firmware::protocol::StreamState;
use std::io::{Read, Write};

/// A controller that can be driven.
pub trait Controlled {
    /// The connection to it.
    type Line: Read + Write;

    /// The client of the connection.
    fn client(&mut self) -> &mut Client<Self::Line>;

    /// Lets some 10 ms of the controller's time pass.
    ///
    /// # Errors
    /// The connection failed.
    fn pass_time(&mut self) -> Result<(), LinkError>;

    /// What the controller has told of a stream.
    fn note_stream(&mut self, _: &StreamState) {}
}

/// A controller with a clock of its own: its client waits for messages meanwhile.
impl<L: Read + Write> Controlled for Client<L> {
    type Line = L;

    fn client(&mut self) -> &mut Self {
        self
    }

    fn pass_time(&mut self) -> Result<(), LinkError> {
        self.poll()
    }
}
