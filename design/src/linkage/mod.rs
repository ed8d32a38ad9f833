//! Planar linkages, solved Assur group by Assur group (WUT).
//!
//! A linkage is a chain of driven links and [dyads](dyad). Each is carried by links that are
//! solved before it. Positions, velocities and accelerations are solved in the order of the
//! chain, forces in the opposite order.

mod check;
mod clearance;
pub mod dyad;
mod forces;
mod four_bar;
mod group;
mod joint;
mod model;
mod modify;
mod motion;
mod parameters;
mod section;
mod solve;
mod statics;
mod sweep;
mod wrench;

pub use check::LinkageError;
pub use clearance::Clearance;
pub use forces::{Forces, Reaction};
pub use four_bar::{FourBar, FourBarType};
pub use group::{Group, Guide, LinkId, PointId};
pub use joint::Joint;
pub use model::{Element, Linkage, NamedLink, Point};
pub use motion::{Coordinate, LinkMotion, PointMotion};
pub use parameters::{Parameter, ParameterKind};
pub use section::BarSection;
pub use solve::{LinkageMotion, SolveError};
pub use statics::reactions;
pub use sweep::{BranchChange, ClosureLimit, DriveLaw, SolvedSample, Sweep, SweepSample};
pub use wrench::Wrench;
