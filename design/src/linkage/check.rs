//! Checks of the parts of a linkage, and the error that names a wrong part.

use super::group::Group;
use core::fmt;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Why a part of a linkage is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LinkageError {
    /// A length is not a positive finite number.
    Length,
    /// A direction is zero or not finite.
    Direction,
    /// A coordinate, an offset or a force is not finite.
    NotFinite,
    /// A mass or moment of inertia is negative or not finite.
    Inertia,
    /// A clearance is negative or not finite.
    Clearance,
    /// A clearance was given to a joint other than a pin.
    NotAPin,
    /// A section was given to a link that is not a bar between two points.
    NotABar,
}

impl fmt::Display for LinkageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Length => "every length must be a positive finite number of metres",
            Self::Direction => "a direction must be finite and not zero",
            Self::NotFinite => "every number must be finite",
            Self::Inertia => "mass and inertia must be finite and not negative",
            Self::Clearance => "a clearance must be finite and not negative",
            Self::NotAPin => "only a pin may have a clearance",
            Self::NotABar => {
                "only a crank with a point, or a dyad's bar of given length, may have a section"
            }
        })
    }
}

impl core::error::Error for LinkageError {}

impl<S: Scalar> Group<S> {
    /// The same group with unit directions, if its numbers are valid.
    pub(super) fn validated(mut self) -> Result<Self, LinkageError> {
        match &mut self {
            Self::Crank { .. } => {}
            Self::Slider { guide } => normalise(&mut guide.direction)?,
            Self::Rrr { dyad, .. } => {
                positive(dyad.lengths[0])?;
                positive(dyad.lengths[1])?;
            }
            Self::Rrp { dyad, guide, .. } => {
                positive(dyad.length)?;
                finite(Vector2::new(dyad.offset, S::ZERO))?;
                normalise(&mut guide.direction)?;
            }
            Self::Rpr { dyad, .. } => finite(Vector2::new(dyad.offset, S::ZERO))?,
            Self::Prp { dyad, guides } => {
                let [e1, e2] = dyad.offsets;
                finite(Vector2::new(e1, e2))?;
                for guide in guides {
                    normalise(&mut guide.direction)?;
                }
            }
            Self::Rpp { dyad, guide, .. } => {
                normalise(&mut dyad.direction)?;
                normalise(&mut guide.direction)?;
            }
        }
        Ok(self)
    }
}

fn positive<S: Scalar>(length: S) -> Result<(), LinkageError> {
    if length > S::ZERO && length.is_finite() {
        Ok(())
    } else {
        Err(LinkageError::Length)
    }
}

pub(super) fn not_negative<S: Scalar>(value: S) -> Result<(), LinkageError> {
    if value >= S::ZERO && value.is_finite() {
        Ok(())
    } else {
        Err(LinkageError::Inertia)
    }
}

pub(super) fn finite<S: Scalar>(vector: Vector2<S>) -> Result<(), LinkageError> {
    if vector.x.is_finite() && vector.y.is_finite() {
        Ok(())
    } else {
        Err(LinkageError::NotFinite)
    }
}

fn normalise<S: Scalar>(direction: &mut Vector2<S>) -> Result<(), LinkageError> {
    let norm = direction.length();
    if norm > S::ZERO && norm.is_finite() {
        *direction *= S::ONE / norm;
        Ok(())
    } else {
        Err(LinkageError::Direction)
    }
}
