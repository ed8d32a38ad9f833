//! The ways to a controller: in this process, or as a stream of bytes whose reads give up
//! in time, to an emulated board or over a serial line. A [`Conversation`] asks its
//! questions over such a stream. A run needs a [`Target`], wherever that is.

mod conversation;
mod emulator;
mod in_process;
mod target;

pub use conversation::{Conversation, LinkError};
pub use emulator::{Emulator, EmulatorError};
pub use in_process::InProcess;
pub use target::{Target, TargetError};
