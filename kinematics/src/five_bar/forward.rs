//! Forward position: from the driven angles to C. An offset tool follows from the pose:
//! [`Tool::point`](super::Tool::point).
//!
//! Yu 2007 solves rC = rB + l2 u(θ2) = rD + l3 u(θ3) by a half-angle formula
//! ([`Geometry::half_angle_forward`]); the same two roots by intersecting the circles
//! about B and D need one square root, one division and no trigonometry:
//!
//! p = rD − rB, a = ½(1 + (l2² − l3²)/|p|²), h² = l2²/|p|² − a², rC = rB + a p ± h p⊥,
//! the upper sign on the `Left` assembly.

use super::dyad::DyadError;
use super::{Geometry, Pose, PoseError, Side, Singularity, Unreachable};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

impl<S: Scalar> Geometry<S> {
    /// The pose with driven angles θ1, θ4 [rad] on the given assembly branch.
    ///
    /// # Errors
    /// `Unreachable` where links 2 and 3 cannot meet, `Singular` where B meets D to
    /// rounding, `NotFinite`. A pose with B, C, D in line is returned; its velocities are refused.
    #[inline(always)]
    pub fn forward(&self, theta1: S, theta4: S, assembly: Side) -> Result<Pose<S>, PoseError> {
        self.forward_from_directions(Vector2::unit(theta1), Vector2::unit(theta4), assembly)
    }

    /// As [`Geometry::forward`], the driven links given by their unit vectors.
    ///
    /// # Errors
    /// As [`Geometry::forward`].
    #[inline(always)]
    pub fn forward_from_directions(
        &self,
        u1: Vector2<S>,
        u4: Vector2<S>,
        assembly: Side,
    ) -> Result<Pose<S>, PoseError> {
        let b = u1 * self.l1();
        let d = Vector2::new(self.base() + u4.x * self.l4(), u4.y * self.l4());
        let bc = self.tip().joint(d - b, assembly).map_err(refusal)?;
        let c = b + bc;
        let [_, per_l2, per_l3, _] = self.per_length();
        Ok(Pose {
            u1,
            u2: bc * per_l2,
            u3: (c - d) * per_l3,
            u4,
            b,
            c,
            d,
        })
    }
}

pub(super) fn refusal<S: Scalar>(error: DyadError<S>) -> PoseError {
    match error {
        DyadError::TooFar => PoseError::Unreachable(Unreachable::ElbowsTooFar),
        DyadError::TooNear => PoseError::Unreachable(Unreachable::ElbowsTooNear),
        DyadError::InLine(_) | DyadError::Coincident => PoseError::Singular(Singularity::Parallel),
        DyadError::NotFinite => PoseError::NotFinite,
    }
}
