//! Dynamics of the five-bar by Kane's method (Yu 2007, section 2). Letters, frames and
//! signs are drawn in `docs/notation.md`.

mod body;
mod energy;
mod kane;
mod mass;
mod reactions;
mod regrouped;
mod shares;

pub use body::{Arm, Link, ModelError};
pub use kane::PartialVelocities;
pub use reactions::Reactions;
pub use regrouped::Regrouped;
pub use shares::{ShareTotals, TorqueShares};
