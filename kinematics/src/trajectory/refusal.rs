//! Why a path is not accepted, and where.

use crate::five_bar::{Joint, Outside};
use core::fmt;
use nalgebra::Vector2;

/// What stands in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Obstacle {
    /// The tool may not be there.
    Outside(Outside),
    /// The joint's greatest torque cannot hold the arm there, however slowly it moves.
    Torque(Joint),
    /// A speed or a limit given is not a positive finite number.
    Limits,
}

/// The first place found on a path that cannot be passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal<S> {
    /// How far along the path, 0…1.
    pub fraction: S,
    /// The tool there [m].
    pub point: Vector2<S>,
    /// Why.
    pub obstacle: Obstacle,
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outside(outside) => outside.fmt(f),
            Self::Torque(joint) => write!(f, "{joint} has not the torque to hold the arm"),
            Self::Limits => f.write_str("a speed or limit is not a positive finite number"),
        }
    }
}
