//! Planar linkages, solved Assur group by Assur group (WUT).
//!
//! A linkage is a chain of driven links and [dyads](dyad), each carried by what was
//! solved before it. Positions, velocities and accelerations go down the chain; forces
//! come back up it, dyad by dyad.

mod check;
mod clearance;
pub mod dyad;
mod forces;
mod four_bar;
mod model;
mod motion;
mod parameters;
mod solve;
mod statics;
mod sweep;

pub use check::Invalid;
pub use clearance::{Clearance, Section};
pub use forces::{Forces, Reaction};
pub use four_bar::{FourBar, FourBarType};
pub use model::{Element, Group, Guide, LinkId, Linkage, NamedLink, Point, PointId};
pub use motion::{Coordinate, LinkMotion, PointMotion};
pub use parameters::{Parameter, Quantity};
pub use solve::{Motion, SolveError};
pub use statics::{Joint, Wrench, reactions};
pub use sweep::{BranchChange, Law, Limit, Sample, Solved, Sweep};
