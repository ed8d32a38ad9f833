//! The number the models are generic over.
//!
//! | type | where | functions |
//! |---|---|---|
//! | `f32` | the controller's tick, on the target and on a desktop | the crate's own polynomials, IEEE square root: the same bits everywhere |
//! | `f64` | the desktop: queries, design, references for tests | `libm` |
//! | `Dual` of the crate `fivebar-design` | sensitivities | derivatives carried along |

mod double;
mod fixed_point;
mod single;

pub use fixed_point::FixedPointSquare;

use core::ops::Neg;
use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::{One, Zero};

/// A real number as the models use it.
///
/// Comparisons use the value only, so that a dual number takes the same branch as its value.
///
/// ```
/// use fivebar_kinematics::Scalar;
///
/// /// |(x, y)| of any of the crate's numbers.
/// fn norm<S: Scalar>(x: S, y: S) -> S {
///     (x * x + y * y).sqrt()
/// }
/// assert_eq!(norm(3.0_f32, 4.0), 5.0);
/// assert_eq!(norm(0.3_f64, 0.4), 0.5);
/// // The crate's own sine in f32 is within 9e-8.
/// let (sin, _) = Scalar::sin_cos(0.5_f32);
/// assert!((f64::from(sin) - 0.5_f64.sin()).abs() < 9e-8);
/// ```
pub trait Scalar:
    nalgebra::Scalar
    + Copy
    + PartialOrd
    + Zero
    + One
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
    + Neg<Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// ½.
    const HALF: Self;
    /// 2.
    const TWO: Self;
    /// The distance from 1 to the next number: the greatest relative rounding error is half of
    /// it.
    const EPSILON: Self;

    /// The number nearest to `value`; for constants.
    fn from_f64(value: f64) -> Self;
    /// The value, without any derivative it carries.
    fn to_f64(self) -> f64;
    /// √x, correctly rounded for the plain types. NaN below zero.
    fn sqrt(self) -> Self;
    /// (sin x, cos x), x in radians.
    fn sin_cos(self) -> (Self, Self);
    /// This number where `sign_bit` is 0, its negative where it is 1 << 31.
    #[inline(always)]
    #[must_use]
    fn xor_sign(self, sign_bit: u32) -> Self {
        if sign_bit == 0 { self } else { -self }
    }
    /// Sine and cosine of two angles; one call takes fewer instructions than two.
    #[inline(always)]
    fn sin_cos_both([first, second]: [Self; 2]) -> [(Self, Self); 2] {
        [first.sin_cos(), second.sin_cos()]
    }
    /// The angle of (x, y) in (−π, π], `self` being y.
    fn atan2(self, x: Self) -> Self;

    /// `square` − x² − y², where `fixed` is `square` in fixed point. `f32` computes it with
    /// 64-bit integers, without cancellation.
    #[inline(always)]
    fn difference_of_squares(square: Self, _fixed: &FixedPointSquare, x: Self, y: Self) -> Self {
        square - (x * x + y * y)
    }

    /// As [`Scalar::difference_of_squares`] with x − `pivot` for x; `pivot` is that of `fixed`.
    #[inline(always)]
    fn difference_of_squares_from_pivot(
        square: Self,
        fixed: &FixedPointSquare,
        pivot: Self,
        x: Self,
        y: Self,
    ) -> Self {
        Self::difference_of_squares(square, fixed, x - pivot, y)
    }

    /// |x|.
    #[inline]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }

    /// Whether the number is neither infinite nor NaN.
    #[inline]
    #[allow(clippy::eq_op)]
    fn is_finite(self) -> bool {
        // x − x is 0 for every finite x and NaN for the others.
        self - self == Self::ZERO
    }
}
