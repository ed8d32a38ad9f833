//! The distances between the ends of a dyad that keep the singularity margin.

use super::error::ConstraintViolation;
use super::number::{max, min};
use crate::Scalar;
use crate::five_bar::{Singularity, WorkspaceViolation};

/// The reserve to the singularity margin, as a share of it. Without it the steps next to the margin
/// would become infinitely short.
const RESERVE_SHARE: f64 = 0.01;

/// The distances between the ends of a dyad at which it is neither straight nor folded.
#[derive(Clone, Copy)]
pub(super) struct AnnulusConstraint<S> {
    /// a² + b² and 2ab [m²].
    sum: S,
    product: S,
    /// Edges of the margin, and of the margin with its reserve [m].
    margin: [S; 2],
    reserve: [S; 2],
    singularity: Singularity,
}

impl<S: Scalar> AnnulusConstraint<S> {
    pub(super) fn new(a: S, b: S, margin: S, singularity: Singularity) -> Self {
        let sum = a * a + b * b;
        let product = S::TWO * a * b;
        let edges = |margin: S| {
            let cos = max(S::ONE - margin * margin, S::ZERO).sqrt();
            [sum - product * cos, sum + product * cos].map(S::sqrt)
        };
        Self {
            sum,
            product,
            margin: edges(margin),
            reserve: edges(margin * S::from_f64(1.0 + RESERVE_SHARE)),
            singularity,
        }
    }

    /// The clearance of `distance` from the edges [m].
    pub(super) fn clearance(&self, distance: S) -> Result<S, ConstraintViolation> {
        let [near, far] = self.margin;
        let [reserve_near, reserve_far] = self.reserve;
        if reserve_near <= distance && distance <= reserve_far {
            Ok(min(distance - near, far - distance))
        } else {
            Err(WorkspaceViolation::Margin(self.singularity).into())
        }
    }

    /// The least distance that keeps the margin [m].
    pub(super) fn nearest(&self) -> S {
        self.margin[0]
    }

    /// The least |sin φ| while `distance` changes by no more than `change` [m].
    pub(super) fn least_sine(&self, distance: S, change: S) -> S {
        self.least_sine_between([distance - change, distance + change])
    }

    /// The least |sin φ| between two distances [m], if both keep the margin.
    pub(super) fn least_sine_within(&self, [low, high]: [S; 2]) -> Option<S> {
        let [near, far] = self.margin;
        (near <= low && high <= far).then(|| self.least_sine_between([low, high]))
    }

    /// φ is monotone in the distance, so its least sine is at one end.
    fn least_sine_between(&self, [low, high]: [S; 2]) -> S {
        let sine = |distance: S| {
            let cos = (distance * distance - self.sum) / self.product;
            max(S::ONE - cos * cos, S::ZERO).sqrt()
        };
        min(sine(low), sine(high))
    }
}
