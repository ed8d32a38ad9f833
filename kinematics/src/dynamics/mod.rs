//! Dynamics of the five-bar by Kane's method (Yu 2007, section 2).

mod body;
mod energy;
mod kane;
mod mass;
mod reactions;
mod shares;

pub use body::{Arm, Link, ModelError};
pub use kane::PartialVelocities;
pub use mass::MassMatrix;
pub use reactions::Reactions;
pub use shares::{ShareTotals, TorqueShares};
