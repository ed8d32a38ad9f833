//! Signs of life that wait to be read. A server that gets little time reads late what a lost page has
//! sent, and would take it for alive.
//!
//! The time at which a connection's receive queue was last empty.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::Instant;

/// Bytes that are read later arrived after a time at which nothing was left.
pub(super) struct Backlog {
    emptied: Instant,
    /// The connection, to ask the system whether anything is left.
    probe: Option<TcpStream>,
}

impl Backlog {
    /// Nothing is left at `emptied`.
    pub(super) fn new(probe: Option<TcpStream>, emptied: Instant) -> Self {
        Self { emptied, probe }
    }

    /// The latest time at which nothing was left.
    pub(super) fn emptied(&self) -> Instant {
        self.emptied
    }

    /// Notes that a reading that began at this time left nothing.
    pub(super) fn empty_at(&mut self, begun: Instant) {
        self.emptied = begun;
    }

    /// Asks the system whether nothing is left, as the runtime says without asking it. `begun` is a time
    /// before that.
    pub(super) fn look(&mut self, begun: Instant) {
        let peeked = self.probe.as_ref().map(|probe| probe.peek(&mut [0]));
        if let Some(Err(error)) = peeked
            && error.kind() == ErrorKind::WouldBlock
        {
            self.emptied = begun;
        }
    }
}
