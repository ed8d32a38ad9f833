//! The protocol between a host and a controller, in two layers: a checked [frame](Frame) and the
//! [message](HostMessage) in it. Both ends use this module; `docs/design/protocol.md` describes the
//! bytes.
//!
//! The host sends commands, the controller replies: one [`HostCommand`] at a time, each with a sequence
//! number that its [`Reply`] repeats. A command that comes again with the same number
//! gets the stored reply and is executed only once, so a host that receives no reply sends its
//! command again. [`Telemetry`] is sent between replies, without a command for each sample. The points of a
//! stream get no reply either, and [`StreamState`] is sent while it lasts.

mod board_test;
mod decoder;
mod encode;
mod frame;
mod identity;
mod message;
mod reply;
mod section;
mod sequence;
mod step_result;
mod stream;

pub use board_test::{
    BoardFacts, BoardReport, BoardTest, FlashTime, TIMING_BIN, TIMING_BINS, TimedSpan, Timing,
};
pub use decoder::{Decoder, LinkCounts};
pub use encode::encode;
pub use frame::{Frame, FrameError, MAX_CONTENT, MAX_FRAME, Message, Sender};
pub use identity::{Board, Identity, Reset};
pub use message::{HostCommand, HostMessage};
pub use reply::{CommandError, ControllerMessage, Reply, StackUse, Telemetry};
pub use section::{Section, SectionKey};
pub use sequence::{Sequence, SequenceCheck};
pub use step_result::StepResult;
pub use stream::StreamState;

/// Version of everything in this module. Both ends must have the same; [`HostCommand::Hello`]
/// and [`CommandError::Version`] keep their bytes in every version, so that two ends of
/// different versions can find out.
pub const VERSION: u16 = 2;
