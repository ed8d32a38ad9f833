//! The planar five-bar: positions, velocities and accelerations both ways, on all
//! eight branches (Yu 2007, section 1; corrected where its print errs). Letters, frames
//! and signs are drawn in `docs/design/notation.md`.

mod actuated;
mod branch;
mod closed_form;
mod dyad;
mod error;
mod foot;
mod forward;
mod geometry;
mod inverse;
mod jacobian;
mod joint;
mod limits;
mod links;
mod motion;
mod pose;
mod reach;
mod singularity;
mod tool;
mod workspace;

pub use actuated::ActuatedJointState;
pub use branch::{Side, WorkingMode};
pub use dyad::{Dyad, DyadError, DyadSolution};
pub use error::{GeometryError, PoseError, Singularity, Unreachable};
pub use foot::FootDrive;
pub use geometry::Geometry;
pub use jacobian::{InverseJacobian, Jacobian};
pub use joint::Joint;
pub use limits::{JointLimitError, JointLimits};
pub use links::{Links, PartialRates};
pub(crate) use motion::per_sine;
pub use motion::{Accelerations, Velocities};
pub use pose::Pose;
pub use singularity::{Clearance, Clearances};
pub use tool::Tool;
pub use workspace::{Workspace, WorkspaceViolation};
