//! Safety: the states, the faults, and the monitor that detects faults.

mod fault;
mod monitor;
mod seen;
mod state;

pub use fault::{Fault, Limits, Response};
pub(crate) use monitor::{Monitor, NOTICED_WITHIN, TOLERATED_TICKS};
pub use seen::DriveKind;
pub use state::{Event, State};
