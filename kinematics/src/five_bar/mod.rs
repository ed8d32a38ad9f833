//! The planar five-bar: positions, velocities and accelerations both ways, on all
//! eight branches (Yu 2007, section 1; corrected where its print errs).

mod branch;
mod error;
mod forward;
mod geometry;
mod inverse;
mod motion;
mod pose;

pub use branch::{Side, WorkingMode};
pub use error::{GeometryError, PoseError, Singularity, Unreachable};
pub use geometry::Geometry;
pub use motion::{Accelerations, Velocities};
pub use pose::Pose;
