//! Why a path is not accepted, and at which point.

use crate::five_bar::{Joint, WorkspaceViolation};
use core::fmt;
use nalgebra::Vector2;

/// The constraint that a path violates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ConstraintViolation {
    /// The tool would be outside the workspace.
    Workspace(WorkspaceViolation),
    /// The joint's greatest torque cannot hold the arm there, at any speed.
    Torque(Joint),
    /// A speed or a limit given is not a positive finite number.
    Limits,
}

/// The first point found on a path that violates a constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathError<S> {
    /// The place along the path, as a share 0…1 of its length.
    pub fraction: S,
    /// The tool there [m].
    pub point: Vector2<S>,
    /// The violated constraint.
    pub violation: ConstraintViolation,
}

impl fmt::Display for ConstraintViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Workspace(violation) => violation.fmt(f),
            Self::Torque(joint) => write!(f, "{joint} has not the torque to hold the arm"),
            Self::Limits => f.write_str("a speed or limit is not a positive finite number"),
        }
    }
}
