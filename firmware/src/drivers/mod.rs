//! Drivers of the bridges and inputs over the traits of embedded-hal. They run on any board and
//! are tested on a desktop.

mod bridge;
mod debounce;
mod inputs;

pub use bridge::Bridge;
pub use debounce::Debounce;
pub use inputs::Inputs;
