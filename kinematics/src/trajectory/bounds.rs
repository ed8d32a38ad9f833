//! Bounds on a curve's derivatives by length: what limits the speed on it.

use super::curve::Curve;
use super::number::max;
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The greatest values along a curve of the quantities that limit the speed on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CurveBounds<S> {
    /// |r′|.
    pub(super) first: S,
    /// |r″| [1/m].
    pub(super) second: S,
    /// |r‴| [1/m²].
    pub(super) third: S,
    /// |r′·r″| [1/m]: the component of r″ along the path.
    pub(super) lean: S,
    /// Whether |r″| is 0 where |r‴| is greatest, as in a corner between lines.
    pub(super) apart: bool,
}

impl<S: Scalar> CurveBounds<S> {
    /// Those of the whole of a curve.
    pub(super) fn of(curve: &Curve<S>) -> Self {
        match *curve {
            Curve::Line { .. } => Self {
                first: S::ONE,
                second: S::ZERO,
                third: S::ZERO,
                lean: S::ZERO,
                apart: false,
            },
            Curve::Arc { curvature, .. } => Self {
                first: S::ONE,
                second: curvature.abs(),
                third: curvature * curvature,
                lean: S::ZERO,
                apart: false,
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
/// Between samples a distance h apart a function exceeds the greater of them by at most
/// h²/8 times its greatest second derivative, and the fourth derivative of a quintic is
/// linear, so its greatest is at an end: samples and that remainder bound the rest.
fn of_quintic<S: Scalar>(coefficients: &[Vector2<S>; 6], inverse_length: S) -> CurveBounds<S> {
    const INTERVALS: u8 = 8;
    let step = S::from_f64(1.0 / f64::from(INTERVALS));
    let [_, c1, c2, c3, c4, c5] = *coefficients;
    let c = S::from_f64;
    let fifth = c5 * c(120.0);
    let fourth = |u: S| c4 * c(24.0) + fifth * u;
    let third = |u: S| c3 * c(6.0) + (c4 * c(24.0) + c5 * (c(60.0) * u)) * u;
    let second = |u: S| c2 * c(2.0) + (c3 * c(6.0) + (c4 * c(12.0) + c5 * (c(20.0) * u)) * u) * u;
    let first =
        |u: S| c1 + (c2 * c(2.0) + (c3 * c(3.0) + (c4 * c(4.0) + c5 * (c(5.0) * u)) * u) * u) * u;

    let m4 = max(fourth(S::ZERO).length(), fourth(S::ONE).length());
    let m5 = fifth.length();
    let (mut m1, mut m2, mut m3, mut lean) = (S::ZERO, S::ZERO, S::ZERO, S::ZERO);
    let mut u = S::ZERO;
    for _ in 0..=INTERVALS {
        m1 = max(m1, first(u).length());
        m2 = max(m2, second(u).length());
        m3 = max(m3, third(u).length());
        lean = max(lean, first(u).dot(&second(u)).abs());
        u += step;
    }
    // h²/8.
    let between = step * step * c(1.0 / 8.0);
    m3 += between * m5;
    m2 += between * m4;
    lean += between * (c(3.0) * m2 * m3 + (m1 + between * m3) * m4);
    m1 += between * m3;
    let per = inverse_length;
    CurveBounds {
        first: m1 * per,
        second: m2 * (per * per),
        third: m3 * (per * per * per),
        lean: lean * (per * per * per),
        apart: c2 == Vector2::zeros() && second(S::ONE).length() <= m2 * c(1e-3),
    }
}
