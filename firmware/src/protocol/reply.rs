//! The messages of the controller.

use super::board_test::BoardReport;
use super::frame::{Message, Sender};
use super::identity::Identity;
use super::section::Section;
use super::sequence::Sequence;
use super::step_result::StepResult;
use super::stream::StreamState;
use crate::ToldSample;
use crate::controller::{self, ExcitationEnd, Snapshot, Status};
use crate::drives::BrushedCommand;
use crate::planner::MoveError;
use crate::planner::StreamError;
use crate::recorder::LogPage;
use crate::storage::StorageError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// A reply to a command, or a sample of telemetry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ControllerMessage<C = BrushedCommand> {
    /// The reply to a command.
    Reply {
        /// The command's number.
        sequence: Sequence,
        /// The reply.
        reply: Reply<C>,
    },
    /// A sample.
    Telemetry(Telemetry),
    /// What a stream of set-points does.
    Stream(StreamState),
}

impl<C: Serialize + DeserializeOwned> Message for ControllerMessage<C> {
    const SENDER: Sender = Sender::Controller;
}

/// The reply to a command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Reply<C = BrushedCommand> {
    /// The command was not executed; nothing has changed.
    Refused(CommandError),
    /// Done, or begun if it takes time: the status shows when it has ended, and of a stream [`StreamState`].
    Done,
    /// To a hello.
    Hello(Identity),
    /// To [`HostCommand::Status`](super::HostCommand::Status).
    Status {
        /// The controller after its last tick.
        status: Status,
        /// The number of moves that can be accepted now.
        free: u8,
    },
    /// To [`HostCommand::Snapshot`](super::HostCommand::Snapshot): none where no fault is latched.
    Snapshot(Option<Snapshot>),
    /// To a move: its whole path was checked, and it was accepted.
    Taken {
        /// The number of further moves that can be accepted now.
        free: u8,
    },
    /// To [`HostCommand::GetSection`](super::HostCommand::GetSection).
    Section(Section),
    /// To [`HostCommand::Tick`](super::HostCommand::Tick).
    StepResult(StepResult<C>),
    /// To [`HostCommand::Stack`](super::HostCommand::Stack).
    Stack(StackUse),
    /// To [`HostCommand::Sample`](super::HostCommand::Sample).
    Sample(ToldSample),
    /// To [`HostCommand::ReadLog`](super::HostCommand::ReadLog).
    Log(LogPage),
    /// To [`HostCommand::ExcitationEnd`](super::HostCommand::ExcitationEnd): none while it lasts,
    /// and before the first one.
    ExcitationEnd(Option<ExcitationEnd>),
    /// To [`HostCommand::BoardTest`](super::HostCommand::BoardTest), where a step reports something.
    Board(BoardReport),
}

/// How much of the stack has been in use since the reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StackUse {
    /// The most that was used [bytes].
    pub most: u32,
    /// Its size [bytes].
    pub size: u32,
}

/// Why a command was not executed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum CommandError {
    /// The host uses another version than this one, the controller's.
    Version(u16),
    /// No hello has come since the reset.
    NoSession,
    /// The command is not the next one; this number is.
    OutOfSequence(Sequence),
    /// This board cannot do that.
    Unsupported,
    /// The controller refused the request.
    Request(controller::RequestError),
    /// The planner refused the move.
    Move(MoveError),
    /// No settings are stored and none have been applied: the arm does not move on default
    /// settings.
    NoSettings,
    /// No such section of the settings.
    NoSection,
    /// The draft of the settings is invalid as a whole.
    Settings,
    /// The settings could not be stored.
    Storage(StorageError),
    /// The log has no signals, or rows 0 ticks apart.
    Log,
    /// The stream of set-points does not begin.
    Stream(StreamError),
}

/// A sample of the status.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Telemetry {
    /// Number of samples due since telemetry began, also of those not sent: a gap is a loss.
    pub number: u32,
    /// The sample.
    pub status: Status,
}

impl core::fmt::Display for CommandError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Version(version) => write!(f, "it uses protocol version {version}"),
            Self::NoSession => f.write_str("it has received no hello since its reset"),
            Self::OutOfSequence(Sequence(next)) => write!(f, "it expects command number {next}"),
            Self::Unsupported => f.write_str("this board cannot do that"),
            Self::Request(error) => error.fmt(f),
            Self::Move(error) => error.fmt(f),
            Self::NoSettings => f.write_str("it has no settings: upload the arm's"),
            Self::NoSection => f.write_str("it has no such section of the settings"),
            Self::Settings => f.write_str("the settings are invalid as a whole"),
            Self::Storage(error) => write!(f, "the settings were not stored: {error}"),
            Self::Stream(error) => error.fmt(f),
            Self::Log => f.write_str("a log needs a signal, and rows one tick apart or more"),
        }
    }
}

impl core::error::Error for CommandError {}
