//! The controller that is chosen, opened: simulated in real time, on an emulated board, or on a port.

mod command_error;
mod pace;
mod simulated;
mod source;

pub use command_error::sentence;
pub use pace::SpeedMeter;
pub use simulated::SteppedArm;
pub use source::{Connection, ControllerSource, OpenError, Opened, open};
