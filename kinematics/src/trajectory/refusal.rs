//! Why a path is not accepted, and where.

use crate::Vec2;
use crate::five_bar::{PoseError, Singularity};
use core::fmt;

/// What stands in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// No pose there.
    Pose(PoseError),
    /// Within the singularity margin.
    NearSingularity(Singularity),
    /// The joint's angle is outside its limits.
    JointLimit(Joint),
    /// The joint's torque does not hold the arm there, however slowly it moves.
    Torque(Joint),
    /// A speed or a limit given is not a positive finite number.
    Limits,
}

/// One of the two driven joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// At A.
    One,
    /// At E.
    Four,
}

/// The first place on a path that cannot be passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal<S> {
    /// How far along the path, 0…1.
    pub fraction: S,
    /// The tool there [m].
    pub point: Vec2<S>,
    /// Why.
    pub obstacle: Obstacle,
}

impl fmt::Display for Joint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::One => "joint 1",
            Self::Four => "joint 4",
        })
    }
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pose(error) => error.fmt(f),
            Self::NearSingularity(which) => write!(f, "too near a singularity: {which}"),
            Self::JointLimit(joint) => write!(f, "{joint} would pass its angle limits"),
            Self::Torque(joint) => write!(f, "{joint} has not the torque to hold the arm"),
            Self::Limits => f.write_str("a speed or limit is not a positive finite number"),
        }
    }
}
