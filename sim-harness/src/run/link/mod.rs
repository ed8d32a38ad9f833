//! The ways to a controller: in this process, or as a stream of bytes whose reads give up
//! in time, to an emulated board or over a serial line. A [`Conversation`] asks its
//! questions over such a stream; [`Faulty`] and [`Tracer`] stand between the two. A run
//! needs a [`Target`], wherever that is.

mod conversation;
mod emulator;
mod faulty;
mod frames;
mod in_process;
mod kept_child;
mod lockstep;
mod loopback;
mod serial;
mod target;
mod tracer;

use std::time::Duration;

pub use conversation::{Conversation, LinkError};
pub use emulator::{Emulator, EmulatorError};
pub use faulty::{Faulty, Mishaps};
pub use in_process::InProcess;
pub use lockstep::{Difference, Instructions, Lockstep, LockstepError};
pub use loopback::{Loopback, Plant};
pub use serial::{BAUD, PortError, SerialLine};
pub use target::{Target, TargetError};
pub use tracer::Tracer;

/// How long a read of a line waits before it gives up with
/// [`TimedOut`](std::io::ErrorKind::TimedOut).
pub const READ: Duration = Duration::from_millis(10);
