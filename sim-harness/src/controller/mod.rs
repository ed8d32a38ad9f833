//! The controller that is chosen, opened: simulated in real time, on an emulated board, or on a port.

mod command_error;
mod hand;
mod pace;
mod session;
mod simulated;
mod source;

pub use command_error::sentence;
pub use hand::{Hand, HandError};
pub use pace::SpeedMeter;
pub use session::Session;
pub use source::{Connection, ControllerSource, OpenError, open};
