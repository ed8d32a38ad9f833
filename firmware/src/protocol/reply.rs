//! What the controller says.

use super::frame::{Message, Sender};
use super::identity::Identity;
use super::section::Section;
use super::sequence::Sequence;
use super::ticked::Ticked;
use crate::controller::{self, Snapshot, Status};
use crate::planner::MoveRefusal;
use crate::storage::StorageError;
use serde::{Deserialize, Serialize};

/// An answer, or a sample nobody asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ControllerMessage {
    /// The answer to an order.
    Reply {
        /// The order's number.
        sequence: Sequence,
        /// The answer.
        reply: Reply,
    },
    /// A sample.
    Telemetry(Telemetry),
}

impl Message for ControllerMessage {
    const SENDER: Sender = Sender::Controller;
}

/// The answer to an order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reply {
    /// The order was not obeyed, and nothing changed.
    Refused(Refusal),
    /// Done, or begun where it takes time: the status shows when it ends.
    Done,
    /// To a hello.
    Hello(Identity),
    /// To [`Order::Status`](super::Order::Status).
    Status {
        /// The controller after its last tick.
        status: Status,
        /// How many moves can be taken now.
        room: u8,
    },
    /// To [`Order::Snapshot`](super::Order::Snapshot): none where no fault is latched.
    Snapshot(Option<Snapshot>),
    /// To a move: it was checked along its whole way and taken.
    Taken {
        /// How many more can be taken now.
        room: u8,
    },
    /// To [`Order::GetSection`](super::Order::GetSection).
    Section(Section),
    /// To [`Order::Tick`](super::Order::Tick).
    Ticked(Ticked),
    /// To [`Order::Stack`](super::Order::Stack).
    Stack(StackUse),
}

/// How much of the stack has been in use since the reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StackUse {
    /// At most [bytes].
    pub most: u32,
    /// Its size [bytes].
    pub size: u32,
}

/// Why an order was not obeyed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal {
    /// The host speaks another version than this.
    Version(u16),
    /// There was no hello since the reset.
    NoSession,
    /// The order is not the next one; this number is.
    OutOfSequence(Sequence),
    /// This board cannot do that.
    Unsupported,
    /// The controller refuses the request.
    Request(controller::Refusal),
    /// The planner does not take the move.
    Move(MoveRefusal),
    /// There are no stored settings, and none have been applied: nothing moves on settings
    /// of the program's own choice.
    NoSettings,
    /// No such section of the settings.
    NoSection,
    /// The settings make no sense as a whole.
    Settings,
    /// The settings could not be stored.
    Storage(StorageError),
}

/// A sample of the status.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Telemetry {
    /// Counts the samples due since telemetry began, sent or not: a gap is a loss.
    pub number: u32,
    /// The sample.
    pub status: Status,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Version(version) => write!(f, "it speaks protocol version {version}"),
            Self::NoSession => f.write_str("it has heard no hello since its reset"),
            Self::OutOfSequence(Sequence(next)) => write!(f, "it expects order number {next}"),
            Self::Unsupported => f.write_str("this board cannot do that"),
            Self::Request(refusal) => refusal.fmt(f),
            Self::Move(refusal) => refusal.fmt(f),
            Self::NoSettings => f.write_str("it has no settings: upload the arm's"),
            Self::NoSection => f.write_str("it knows no such section of the settings"),
            Self::Settings => f.write_str("the settings make no sense as a whole"),
            Self::Storage(error) => write!(f, "the settings were not stored: {error}"),
        }
    }
}

impl core::error::Error for Refusal {}
