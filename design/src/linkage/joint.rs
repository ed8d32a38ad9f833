//! The joints of a dyad and what they can carry.

use super::wrench::Wrench;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// A joint of a dyad, where it is now. Frictionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint<S> {
    /// A pin: carries any force through its centre.
    Revolute {
        /// Its centre [m].
        at: Vector2<S>,
    },
    /// A slide: carries a force square to its direction and a moment.
    Prismatic {
        /// The slider's point at which the force is taken to act [m].
        at: Vector2<S>,
        /// Its direction, a unit vector.
        axis: Vector2<S>,
    },
}

impl<S: Scalar> Joint<S> {
    /// The centre of the joint [m]: the point to refer its moment to.
    pub fn place(&self) -> Vector2<S> {
        match *self {
            Self::Revolute { at } | Self::Prismatic { at, .. } => at,
        }
    }

    /// The same joint, `by` [m] away.
    pub(super) fn moved(&self, by: Vector2<S>) -> Self {
        match *self {
            Self::Revolute { at } => Self::Revolute { at: at + by },
            Self::Prismatic { at, axis } => Self::Prismatic { at: at + by, axis },
        }
    }

    /// The two wrenches that the joint can carry.
    #[inline]
    pub(super) fn basis(&self) -> [Wrench<S>; 2] {
        match *self {
            Self::Revolute { at } => [
                Wrench::at(at, Vector2::new(S::ONE, S::ZERO)),
                Wrench::at(at, Vector2::new(S::ZERO, S::ONE)),
            ],
            Self::Prismatic { at, axis } => {
                [Wrench::at(at, axis.perpendicular()), Wrench::couple(S::ONE)]
            }
        }
    }
}
