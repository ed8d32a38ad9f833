//! Drivers of the bridges and inputs over the traits of embedded-hal, what a timer is told for micro-steps, and the order of
//! a tick's frames on a CAN bus. They run on any board and are tested on a desktop.

mod bridge;
pub mod can;
mod inputs;
pub mod steps;

pub use bridge::{Bridge, WAKE_UP_TIME};
pub use inputs::Inputs;
