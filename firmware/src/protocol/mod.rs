//! What a host and a controller say to each other, in two layers: a checked [frame](Frame)
//! and a meaningful [message](HostMessage). Both ends use this module; the bytes are
//! written out in `docs/protocol.md`.
//!
//! The host asks, the controller answers: one [`Order`] at a time, each with a sequence
//! number that its [`Reply`] repeats. An order that comes again with the same number is
//! answered from memory and not obeyed twice, so a host that hears nothing just sends it
//! again. [`Telemetry`] comes unasked between replies.

mod decoder;
mod encode;
mod frame;
mod identity;
mod message;
mod reply;
mod section;
mod sequence;
mod ticked;

pub use decoder::{Decoder, LinkCounts};
pub use encode::encode;
pub use frame::{Frame, FrameError, MAX_CONTENT, MAX_FRAME, Message, Sender};
pub use identity::{Board, Identity, Reset};
pub use message::{HostMessage, Order};
pub use reply::{ControllerMessage, Refusal, Reply, StackUse, Telemetry};
pub use section::{Section, SectionKey};
pub use sequence::{Sequence, Turn};
pub use ticked::Ticked;

/// Version of everything in this module. Both ends must have the same; [`Order::Hello`]
/// and [`Refusal::Version`] keep their bytes in every version, so that two ends that
/// differ can tell each other so.
pub const VERSION: u16 = 1;
