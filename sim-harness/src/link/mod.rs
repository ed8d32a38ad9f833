//! Connections to a controller.
//!
//! A controller runs in this process, on an emulated board or behind a serial line. The
//! last two are streams of bytes whose reads time out. A [`Client`] sends host commands
//! over such a stream; [`FaultInjector`] and [`Tracer`] can wrap the stream. A run uses
//! any controller through the trait [`Target`].

mod client;
mod emulated_drives;
mod emulator;
mod fault_injector;
mod frames;
mod in_process;
mod lockstep;
mod loopback;
#[cfg(not(target_family = "wasm"))]
mod serial;
mod supervised_child;
mod target;
mod tracer;

use std::time::Duration;

pub use client::{Client, LinkError};
pub use emulated_drives::{DesktopDrives, EmulatedDrives, motors_of};
pub use emulator::{Emulator, EmulatorError};
pub use fault_injector::{FaultInjector, FaultRates};
pub use in_process::{Called, InProcess};
pub use lockstep::{Difference, Instructions, Lockstep, LockstepError};
pub use loopback::{Desk, Loopback, Plant};
#[cfg(not(target_family = "wasm"))]
pub use serial::{BAUD, PortError, SerialLine};
pub use target::{Target, TargetError};
pub use tracer::Tracer;

/// A read from a connection fails with [`TimedOut`](std::io::ErrorKind::TimedOut) after
/// this time.
pub const READ: Duration = Duration::from_millis(10);
