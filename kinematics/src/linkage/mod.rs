//! Planar linkages, solved Assur group by Assur group (WUT).
//!
//! A linkage is a chain of driven links and [dyads](dyad), each carried by what was
//! solved before it. Positions, velocities and accelerations go down the chain; forces
//! come back up it, dyad by dyad.

pub mod dyad;
mod motion;
mod statics;

pub use motion::{Coordinate, LinkMotion, PointMotion};
pub use statics::{Joint, Wrench, reactions};
