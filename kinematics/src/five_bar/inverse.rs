//! Inverse position: from the tool to the driven angles.
//!
//! Each leg is a dyad: with r = rC − rA, a = ½(1 + (l1² − l2²)/|r|²) and
//! h = √(l1²/|r|² − a²), rB = rA + a r ∓ h r⊥, the upper sign where the elbow turns
//! `Left` (then B lies right of the ray A→C). Leg 4 alike about E.

use super::{Geometry, Pose, PoseError, Side, Singularity, Unreachable, WorkingMode};
use crate::{Scalar, Vec2};

impl<S: Scalar> Geometry<S> {
    /// The pose that holds the tool at `c` [m] in the given working mode.
    ///
    /// # Errors
    /// `Unreachable` with the leg and the side of its annulus, `Singular` where C meets
    /// a base pivot.
    #[inline]
    pub fn inverse(&self, c: Vec2<S>, mode: WorkingMode) -> Result<Pose<S>, PoseError> {
        if !(c.x.is_finite() && c.y.is_finite()) {
            return Err(PoseError::NotFinite);
        }
        let e = self.e();
        let b = leg(c, self.l1(), self.l2(), mode.elbow1).map_err(|failure| match failure {
            LegFailure::TooFar => PoseError::Unreachable(Unreachable::Leg1TooFar),
            LegFailure::TooNear => PoseError::Unreachable(Unreachable::Leg1TooNear),
            LegFailure::AtPivot => PoseError::Singular(Singularity::Leg1),
        })?;
        let ed =
            leg(c - e, self.l4(), self.l3(), mode.elbow4).map_err(|failure| match failure {
                LegFailure::TooFar => PoseError::Unreachable(Unreachable::Leg4TooFar),
                LegFailure::TooNear => PoseError::Unreachable(Unreachable::Leg4TooNear),
                LegFailure::AtPivot => PoseError::Singular(Singularity::Leg4),
            })?;
        let d = e + ed;
        Ok(Pose {
            u1: b * (S::ONE / self.l1()),
            u2: (c - b) * (S::ONE / self.l2()),
            u3: (c - d) * (S::ONE / self.l3()),
            u4: ed * (S::ONE / self.l4()),
            b,
            c,
            d,
        })
    }
}

enum LegFailure {
    TooFar,
    TooNear,
    AtPivot,
}

/// The elbow, relative to the pivot, of a leg that ends at `r` from the pivot.
#[inline]
fn leg<S: Scalar>(r: Vec2<S>, driven: S, distal: S, elbow: Side) -> Result<Vec2<S>, LegFailure> {
    let r_squared = r.norm_squared();
    if r_squared == S::ZERO {
        return Err(if driven == distal {
            LegFailure::AtPivot
        } else {
            LegFailure::TooNear
        });
    }
    let inverse = S::ONE / r_squared;
    let a = S::HALF * (S::ONE + (driven * driven - distal * distal) * inverse);
    let h_squared = driven * driven * inverse - a * a;
    if h_squared < S::ZERO {
        let too_far = r_squared > (driven + distal) * (driven + distal);
        return Err(if too_far {
            LegFailure::TooFar
        } else {
            LegFailure::TooNear
        });
    }
    Ok(r * a - r.perp() * elbow.sign(h_squared.sqrt()))
}
