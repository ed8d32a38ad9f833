//! Forward position: from the driven angles to the tool.
//!
//! Yu 2007 solves rC = rB + l2 u(θ2) = rD + l3 u(θ3) by a half-angle formula; the same
//! two roots by intersecting the circles about B and D need one square root, one
//! division and no trigonometry:
//!
//! p = rD − rB, a = ½(1 + (l2² − l3²)/|p|²), h = √(l2²/|p|² − a²), rC = rB + a p ± h p⊥,
//! the upper sign on the `Left` assembly.

use super::{Geometry, Pose, PoseError, Side, Singularity, Unreachable};
use crate::{Scalar, Vec2};

impl<S: Scalar> Geometry<S> {
    /// The pose with driven angles θ1, θ4 [rad] on the given assembly branch.
    ///
    /// # Errors
    /// `Unreachable` where links 2 and 3 cannot meet, `Singular` where B meets D.
    #[inline]
    pub fn forward(&self, theta1: S, theta4: S, assembly: Side) -> Result<Pose<S>, PoseError> {
        if !(theta1.is_finite() && theta4.is_finite()) {
            return Err(PoseError::NotFinite);
        }
        self.forward_from_directions(Vec2::unit(theta1), Vec2::unit(theta4), assembly)
    }

    /// As [`Geometry::forward`], the driven links given by their unit vectors.
    ///
    /// # Errors
    /// As [`Geometry::forward`].
    #[inline]
    pub fn forward_from_directions(
        &self,
        u1: Vec2<S>,
        u4: Vec2<S>,
        assembly: Side,
    ) -> Result<Pose<S>, PoseError> {
        let (l2, l3) = (self.l2(), self.l3());
        let b = u1 * self.l1();
        let d = self.e() + u4 * self.l4();
        let p = d - b;
        let p_squared = p.norm_squared();
        if p_squared == S::ZERO {
            return Err(PoseError::Singular(Singularity::Parallel));
        }
        let inverse = S::ONE / p_squared;
        let a = S::HALF * (S::ONE + (l2 * l2 - l3 * l3) * inverse);
        let h_squared = l2 * l2 * inverse - a * a;
        if h_squared < S::ZERO {
            let too_far = p_squared > (l2 + l3) * (l2 + l3);
            return Err(PoseError::Unreachable(if too_far {
                Unreachable::ElbowsTooFar
            } else {
                Unreachable::ElbowsTooNear
            }));
        }
        let h = assembly.sign(h_squared.sqrt());
        let c = b + p * a + p.perp() * h;
        Ok(Pose {
            u1,
            u2: (c - b) * (S::ONE / l2),
            u3: (c - d) * (S::ONE / l3),
            u4,
            b,
            c,
            d,
        })
    }
}
