//! Drivers of the bridges and inputs over the traits of embedded-hal, and what a timer is told for micro-steps. They run on any board and
//! are tested on a desktop.

mod bridge;
mod inputs;
pub mod steps;

pub use bridge::{Bridge, WAKE_UP_TIME};
pub use inputs::Inputs;
