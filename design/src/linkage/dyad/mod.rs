//! Assur dyads: two links and three joints that add no degree of freedom.
//!
//! | dyad | carried by | two links |
//! |---|---|---|
//! | [`Rrr`] | two points | two bars that meet in a pin |
//! | [`Rrp`] | a point, a guide | a bar and a slider pinned to its end |
//! | [`Rpr`] | two points | a bar that is a guide, and a slider on it |
//! | [`Prp`] | two guides | two sliders pinned together |
//! | [`Rpp`] | a point, a guide | a bar that slides in a slider |
//!
//! Positions are solved on a chosen branch; velocities and accelerations are linear in those
//! of the carrying points and guides. WUT derives RRR. The others are derived in the same way,
//! each from one vector equation, which stands above its code.
//!
//! sin μ is the normalised determinant of that linear system, and μ is the dyad's transmission
//! angle: 90° is best, 0 is singular.

mod error;
mod prp;
mod rpp;
mod rpr;
mod rrp;
mod rrr;

pub use error::{DyadError, Singular, Unreachable};
pub use prp::Prp;
pub use rpp::Rpp;
pub use rpr::Rpr;
pub use rrp::Rrp;
pub use rrr::Rrr;

use super::joint::Joint;
use super::motion::{Coordinate, LinkMotion, PointMotion};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The branch of a dyad with a slider: which of its two solutions along the guide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SlideBranch {
    /// The solution farther along the guide's direction.
    Ahead,
    /// The solution farther against it.
    Behind,
}

impl SlideBranch {
    /// Both branches.
    pub const BOTH: [Self; 2] = [Self::Ahead, Self::Behind];

    /// `value` ahead, −`value` behind.
    #[inline]
    pub fn sign<S: Scalar>(self, value: S) -> S {
        match self {
            Self::Ahead => value,
            Self::Behind => -value,
        }
    }

    /// The other branch.
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Ahead => Self::Behind,
            Self::Behind => Self::Ahead,
        }
    }
}

/// A solved dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DyadMotion<S> {
    /// The two links, in the dyad's order.
    pub links: [LinkMotion<S>; 2],
    /// The point that the dyad adds: the inner pin or, in RPR and RPP, the slider.
    pub inner_point: PointMotion<S>,
    /// The displacements of its sliding joints, in the dyad's order.
    pub slides: [Option<Coordinate<S>>; 2],
    /// Outer joint of the first link, inner joint, outer joint of the second link.
    pub joints: [Joint<S>; 3],
    /// sin μ; its sign depends on the branch.
    pub sine: S,
}

impl<S: Scalar> DyadMotion<S> {
    /// μ, the transmission angle [rad], in [0, π/2].
    pub fn transmission_angle(&self) -> S {
        let sine = self.sine.abs();
        let rest = S::ONE - sine * sine;
        let cosine = if rest > S::ZERO { rest.sqrt() } else { S::ZERO };
        sine.atan2(cosine)
    }
}

/// Below this sine the rates have no correct digit: close to a singularity a position
/// is computed from √x, where x has a rounding error of 1e-16, so the position has one of 1e-8.
const SMALLEST_SINE: f64 = 1e-8;

/// Whether rates divided by this sine have correct digits.
#[inline]
pub(crate) fn is_regular<S: Scalar>(sine: S) -> bool {
    let value = sine.to_f64();
    value.is_finite() && value.abs() > SMALLEST_SINE
}

/// `sine` if it is regular, else the singularity as an error.
#[inline]
fn regular<S: Scalar>(sine: S, singular: Singular) -> Result<S, DyadError> {
    if is_regular(sine) {
        Ok(sine)
    } else {
        Err(DyadError::Singular(singular))
    }
}

/// An error if a coordinate is infinite or not a number.
#[inline]
fn finite<S: Scalar>(points: &[Vector2<S>]) -> Result<(), DyadError> {
    if points.iter().all(|p| p.x.is_finite() && p.y.is_finite()) {
        Ok(())
    } else {
        Err(DyadError::NotFinite)
    }
}

/// The point of a guide that is `offset` to the left of its origin.
#[inline]
fn beside<S: Scalar>(guide: &LinkMotion<S>, offset: S) -> Vector2<S> {
    guide.origin.position + guide.axis.perpendicular() * offset
}
