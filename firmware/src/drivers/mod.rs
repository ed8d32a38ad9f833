//! Drivers of the bridges and inputs over the traits of embedded-hal, what a timer is told for micro-steps, and which crystals
//! give the clock. They run on any board and
//! are tested on a desktop.

pub mod boards;
mod bridge;
pub mod crystal;
mod inputs;
pub mod steps;

pub use bridge::{Bridge, WAKE_UP_TIME};
pub use inputs::{Inputs, Level};
