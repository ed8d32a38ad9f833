//! Inverse position: from C to the driven angles. From an offset tool: [`Tool::inverse`].
//!
//! [`Tool::inverse`]: super::Tool::inverse
//!
//! Each leg is a dyad: with r = rC − rA, a = ½(1 + (l1² − l2²)/|r|²) and h² = l1²/|r|² − a²,
//! rB = rA + a r ∓ h r⊥, the upper sign where the elbow turns `Left` (then B lies right of the
//! ray A→C). Leg 4 alike about E. Close to a stretched leg h² is a small difference of large
//! numbers; in `f32` it is computed in fixed point: see [`Scalar::difference_of_squares`].

use super::dyad::{Dyad, DyadError};
use super::{Geometry, Pose, PoseError, Side, Singularity, Unreachable, WorkingMode};
use crate::Scalar;
use nalgebra::Vector2;

/// The part of a pose that leg 4 determines.
pub(super) struct Leg4<S> {
    pub(super) d: Vector2<S>,
    pub(super) u3: Vector2<S>,
    pub(super) u4: Vector2<S>,
}

impl<S: Scalar> Geometry<S> {
    /// The pose that holds C at `c` [m] in the given working mode.
    ///
    /// # Errors
    /// `Unreachable` with the leg and the side of its annulus, `Singular` where C meets a base
    /// pivot to rounding, `NotFinite`. A pose with a straight or folded leg is returned; its
    /// velocities are refused.
    #[inline(always)]
    pub fn inverse(&self, c: Vector2<S>, mode: WorkingMode) -> Result<Pose<S>, PoseError> {
        let [per_l1, per_l2, ..] = self.per_length();
        let leg1 = self.leg1().solve_precisely(c, mode.elbow1.opposite());
        let b = Dyad::joint_of(leg1).map_err(refusal1)?;
        let Leg4 { d, u3, u4 } = self.leg4_to(c, mode.elbow4)?;
        Ok(Pose {
            u1: b * per_l1,
            u2: (c - b) * per_l2,
            u3,
            u4,
            b,
            c,
            d,
        })
    }

    /// Leg 4 when C is at `c`.
    #[inline(always)]
    pub(super) fn leg4_to(&self, c: Vector2<S>, elbow4: Side) -> Result<Leg4<S>, PoseError> {
        let [_, _, per_l3, per_l4] = self.per_length();
        let ec = c - self.e();
        let leg4 = self.leg4().solve_precisely_to(c, elbow4.opposite());
        let ed = Dyad::joint_of(leg4).map_err(refusal4)?;
        Ok(Leg4 {
            d: self.e() + ed,
            u3: (ec - ed) * per_l3,
            u4: ed * per_l4,
        })
    }
}

pub(super) fn refusal1<S: Scalar>(error: DyadError<S>) -> PoseError {
    match error {
        DyadError::TooFar => PoseError::Unreachable(Unreachable::Leg1TooFar),
        DyadError::TooNear => PoseError::Unreachable(Unreachable::Leg1TooNear),
        DyadError::InLine(_) | DyadError::Coincident => PoseError::Singular(Singularity::Leg1),
        DyadError::NotFinite => PoseError::NotFinite,
    }
}

pub(super) fn refusal4<S: Scalar>(error: DyadError<S>) -> PoseError {
    match error {
        DyadError::TooFar => PoseError::Unreachable(Unreachable::Leg4TooFar),
        DyadError::TooNear => PoseError::Unreachable(Unreachable::Leg4TooNear),
        DyadError::InLine(_) | DyadError::Coincident => PoseError::Singular(Singularity::Leg4),
        DyadError::NotFinite => PoseError::NotFinite,
    }
}
