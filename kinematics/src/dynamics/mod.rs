//! Dynamics of the five-bar by Kane's method (Yu 2007, section 2).

mod body;
mod kane;

pub use body::{Arm, Link, ModelError};
pub use kane::PartialVelocities;
