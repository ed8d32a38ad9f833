//! Drivers of what hangs on a board, in terms of the embedded-hal traits: they run on any
//! board and are tested on a desktop.

mod bridge;
mod inputs;

pub use bridge::Bridge;
pub use inputs::Inputs;
