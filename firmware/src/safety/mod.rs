//! What keeps arm and people whole: the states, the faults, and what raises them.

mod fault;
mod monitor;
mod state;

pub use fault::{Fault, Limits, Response};
pub(crate) use monitor::{Monitor, TOLERATED_TICKS};
pub use state::{Event, State};
