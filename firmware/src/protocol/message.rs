//! What the host says.

use super::frame::{Message, Sender};
use super::section::{Section, SectionKey};
use super::sequence::Sequence;
use crate::{Move, Request, Sensed};
use serde::{Deserialize, Serialize};

/// One order, numbered.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HostMessage {
    /// One more than the last order's, or the same when the reply did not come.
    pub sequence: Sequence,
    /// What to do.
    pub order: Order,
}

impl Message for HostMessage {
    const SENDER: Sender = Sender::Host;
}

/// What the controller can be told to do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Order {
    /// Begins a conversation: this order's number is where the counting starts. Whatever
    /// came before is forgotten; telemetry stops.
    Hello {
        /// The host's [`VERSION`](super::VERSION).
        version: u16,
        /// Any number the host did not use lately: tells a repeated hello from a new one.
        session: u32,
    },
    /// Tell the status.
    Status,
    /// Tell what the tick that raised the latched fault saw.
    Snapshot,
    /// Arm, home, stop and the like. An emergency stop is obeyed whatever its number and
    /// without a hello.
    Request(Request),
    /// Add a move to the queue.
    Move(Move),
    /// Tell a section of the settings in use.
    GetSection(SectionKey),
    /// Put a section into the draft, which starts as the settings in use.
    SetSection(Section),
    /// Use the draft, if it makes sense as a whole and the arm is stopped.
    ApplySettings,
    /// Store the settings in use, so that they survive a reset.
    SaveSettings,
    /// Send telemetry every so many ticks; 0 stops it.
    Telemetry {
        /// Ticks from one sample to the next.
        every: u16,
    },
    /// Emulated boards only: these are the samples of the next tick, make it.
    Tick(Sensed),
    /// Tell how much of the stack has been used since the reset.
    Stack,
}
