//! Dynamics of the five-bar by Kane's method (Yu 2007, section 2). Letters, frames and
//! signs are drawn in `docs/design/notation.md`.

mod base_parameters;
mod body;
mod components;
mod energy;
mod kane;
mod mass;
mod reactions;

pub use base_parameters::BaseParameterModel;
pub use body::{Arm, Link, ModelError};
pub use components::{ShareTotals, TorqueComponents};
pub use kane::PartialVelocities;
pub use reactions::Reactions;
