//! The joints of a dyad and the wrenches that they can transmit.

use super::wrench::Wrench;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// A joint of a dyad at its present position, without friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint<S> {
    /// A pin: it transmits any force through its centre.
    Revolute {
        /// Its centre [m].
        at: Vector2<S>,
    },
    /// A slide: it transmits a force perpendicular to its direction, and a moment.
    Prismatic {
        /// The slider's point at which the force acts [m].
        at: Vector2<S>,
        /// Its direction, a unit vector.
        axis: Vector2<S>,
    },
}

impl<S: Scalar> Joint<S> {
    /// The centre of the joint [m], the reference point of its moment.
    pub fn position(&self) -> Vector2<S> {
        match *self {
            Self::Revolute { at } | Self::Prismatic { at, .. } => at,
        }
    }

    /// The same joint, shifted by `by` [m].
    pub(super) fn moved(&self, by: Vector2<S>) -> Self {
        match *self {
            Self::Revolute { at } => Self::Revolute { at: at + by },
            Self::Prismatic { at, axis } => Self::Prismatic { at: at + by, axis },
        }
    }

    /// The two wrenches that the joint can transmit.
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
