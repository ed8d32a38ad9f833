//! Crossing a singularity of type 2 by momentum, from one assembly mode to the other.
//!
//! [`CrossingCondition`] is what the motion must satisfy in the singularity, [`CrossingLaw`] the
//! motion along a line that does, [`CrossingTask::plan`] the one that needs the least torque,
//! [`CrossingControl`] what follows it.

mod condition;
mod control;
mod error;
mod law;
mod line;
mod search;

pub use condition::CrossingCondition;
pub use control::{CrossingControl, CrossingSetpoint};
pub use error::CrossingError;
pub use law::CrossingLaw;
pub use search::{CrossingPlan, CrossingTask};
