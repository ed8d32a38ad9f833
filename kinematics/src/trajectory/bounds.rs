//! Bounds on a curve's derivatives by length: what limits the speed on it.

use super::curve::Curve;
use super::number::max;
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Places from the middle of a blend to its ends.
pub(super) const PLACES: usize = 9;

/// Bounds on the bend of a curve, as far from its middle in both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bend<S> {
    /// |r′|.
    pub(super) first: S,
    /// |r″| [1/m].
    pub(super) second: S,
    /// |r‴| [1/m²].
    pub(super) third: S,
    /// Cosine of the angle between r″ and the path, without sign.
    pub(super) second_lean: S,
    /// Cosine of the angle between the path and the sum of any multiples of r″ and r‴.
    pub(super) third_lean: S,
}

impl<S: Scalar> Bend<S> {
    fn none() -> Self {
        Self {
            first: S::ZERO,
            second: S::ZERO,
            third: S::ZERO,
            second_lean: S::ZERO,
            third_lean: S::ZERO,
        }
    }

    fn add(&mut self, other: &Self) {
        self.first = max(self.first, other.first);
        self.second = max(self.second, other.second);
        self.third = max(self.third, other.third);
        self.second_lean = max(self.second_lean, other.second_lean);
        self.third_lean = max(self.third_lean, other.third_lean);
    }
}

/// The greatest values along a curve of the quantities that limit the speed on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CurveBounds<S> {
    /// |r′|, 1 or more.
    pub(super) first: S,
    /// The bend at places from the middle to the ends; `None` on a line.
    pub(super) bends: Option<[Bend<S>; PLACES]>,
    /// The bend is the same everywhere.
    pub(super) is_even: bool,
}

impl<S: Scalar> CurveBounds<S> {
    /// The greatest |r″| [1/m].
    pub(super) fn second(&self) -> S {
        let bends = self.bends.iter().flatten();
        bends.fold(S::ZERO, |most, bend| max(most, bend.second))
    }

    /// Those of the whole of a curve.
    pub(super) fn of(curve: &Curve<S>) -> Self {
        match *curve {
            Curve::Line { .. } => Self {
                first: S::ONE,
                bends: None,
                is_even: true,
            },
            Curve::Arc { curvature, .. } => Self {
                first: S::ONE,
                bends: Some(
                    [Bend {
                        first: S::ONE,
                        second: curvature.abs(),
                        third: curvature * curvature,
                        second_lean: S::ZERO,
                        // r‴ is along the path.
                        third_lean: S::ONE,
                    }; PLACES],
                ),
                is_even: true,
            },
            Curve::Blend {
                coefficients,
                inverse_length,
            } => of_quintic(&coefficients, inverse_length),
        }
    }
}

/// Bounds on a quintic's derivatives by length.
///
/// Between samples a distance h apart a function exceeds the straight line between them by at most
/// h²/8 times its greatest second derivative, and the fourth derivative of a quintic is linear,
/// so its greatest is at an end: samples and that remainder bound the rest.
fn of_quintic<S: Scalar>(coefficients: &[Vector2<S>; 6], inverse_length: S) -> CurveBounds<S> {
    let c = S::from_f64;
    let step = c(0.5 / (PLACES - 1) as f64);
    let [_, c1, c2, c3, c4, c5] = *coefficients;
    let fifth = c5 * c(120.0);
    let fourth = |u: S| c4 * c(24.0) + fifth * u;
    let third = |u: S| c3 * c(6.0) + (c4 * c(24.0) + c5 * (c(60.0) * u)) * u;
    let second = |u: S| c2 * c(2.0) + (c3 * c(6.0) + (c4 * c(12.0) + c5 * (c(20.0) * u)) * u) * u;
    let first =
        |u: S| c1 + (c2 * c(2.0) + (c3 * c(3.0) + (c4 * c(4.0) + c5 * (c(5.0) * u)) * u) * u) * u;

    // h²/8.
    let between = step * step * c(1.0 / 8.0);
    let of_second = between * max(fourth(S::ZERO).length(), fourth(S::ONE).length());
    let of_third = between * fifth.length();
    // A vector near 0 has no direction: a little of the greatest is added to all.
    let a_little = |lengths: [S; 3]| {
        let greatest = lengths.into_iter().fold(S::ZERO, |a, b| max(a, b));
        greatest * c(0.003)
    };
    let places = [S::ZERO, S::HALF, S::ONE];
    let least_second = of_second + a_little(places.map(|u| second(u).length()));
    let thirds = places.map(|u| third(u).length());
    let least_third = of_third + a_little(thirds);
    // The third derivative is a quadratic: from its ends and middle it rises by an eighth of its
    // second derivative at most.
    let bent = max(thirds[0], max(thirds[1], thirds[2])) + fifth.length() * c(1.0 / 32.0);
    let of_first = between * bent * inverse_length;
    let per = inverse_length;
    let mut greatest = S::ZERO;
    let mut bends = [Bend::none(); PLACES];
    let mut d = S::ZERO;
    for bend in &mut bends {
        for u in [S::HALF + d, S::HALF - d] {
            let (along, second, third) = (first(u), second(u), third(u));
            let length = along.length();
            let lean = |v: Vector2<S>, bound: S| {
                let part = v.dot(&along).abs();
                if part < bound * length {
                    part / (bound * length)
                } else {
                    S::ONE
                }
            };
            let l2 = second.length() + least_second;
            let l3 = third.length() + least_third;
            let second_lean = lean(second, l2);
            bend.add(&Bend {
                first: length * per + of_first,
                second: l2 * (per * per),
                third: l3 * (per * per * per),
                second_lean,
                third_lean: max(second_lean, lean(third, l3)),
            });
            greatest = max(greatest, length);
        }
        d += step;
    }
    CurveBounds {
        first: max(greatest * per + of_first, S::ONE),
        bends: Some(bends),
        is_even: false,
    }
}
