//! The ways to a controller that is not in this process: an emulated board, a serial
//! line. Both are streams of bytes whose reads give up in time; a [`Conversation`] asks
//! its questions over either.

mod conversation;
mod emulator;

pub use conversation::{Conversation, LinkError};
pub use emulator::{Emulator, EmulatorError};
