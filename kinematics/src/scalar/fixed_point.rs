//! The square of a length in fixed point, from which another square is subtracted without
//! cancellation.

use super::Scalar;

/// The square of the sum of two lengths as an integer, in small units.
///
/// The unit of length is the power of two that puts the sum, and the pivot's distance added to
/// it, into 2³⁰…2³¹ units. Valid for lengths from 1e-14 to 1e19 m, whose squares `f32` can
/// represent.
///
/// ```
/// use fivebar_kinematics::Scalar;
/// use fivebar_kinematics::scalar::FixedPointSquare;
///
/// // Close to a stretched leg of 0.26 m, 0.26² − x² is a small difference of large numbers.
/// let (near, far, x) = (0.10_f32, 0.16_f32, 0.259_999_f32);
/// let fixed = FixedPointSquare::of_sum(near, far, 0.0);
/// let square = (near + far) * (near + far);
/// let difference = f32::difference_of_squares(square, &fixed, x, 0.0);
/// let sum = f64::from(near) + f64::from(far);
/// let exact = sum * sum - f64::from(x) * f64::from(x);
/// assert!((f64::from(difference) / exact - 1.0).abs() < 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedPointSquare {
    /// Units per metre.
    scale: f32,
    /// 2³² square units [m²].
    unit: f32,
    /// x of the pivot, in units.
    pivot: i32,
    /// In square units, below 2⁶².
    square: i64,
}

impl FixedPointSquare {
    /// Of nothing.
    pub(crate) const NONE: Self = Self {
        scale: 0.0,
        unit: 0.0,
        pivot: 0,
        square: 0,
    };

    /// The square of the sum of two positive lengths [m], for points about a pivot at
    /// (`pivot`, 0), `pivot` ≥ 0 [m].
    pub fn of_sum<S: Scalar>(first: S, second: S, pivot: S) -> Self {
        let [first, second, pivot] = [first, second, pivot].map(|it| it.to_f64() as f32);
        // 2^(e − 127) ≤ the sum < 2^(e − 126).
        let exponent = ((first + second + pivot).to_bits() >> 23).clamp(80, 191);
        let scale = power_of_two(30 + 127 - exponent as i32);
        let sum = i64::from((first * scale) as i32) + i64::from((second * scale) as i32);
        Self {
            scale,
            unit: power_of_two(32 - 2 * (30 + 127 - exponent as i32)),
            pivot: (pivot * scale) as i32,
            square: sum * sum,
        }
    }

    /// The square minus x² + y² [m²], rounded once.
    #[inline(always)]
    pub(super) fn less(&self, x: f32, y: f32) -> f32 {
        self.rest(self.units(x), self.units(y))
    }

    /// The square minus (x − pivot)² + y² [m²], rounded once.
    #[inline(always)]
    pub(super) fn less_from_pivot(&self, x: f32, y: f32) -> f32 {
        self.rest(self.units(x).saturating_sub(self.pivot), self.units(y))
    }

    /// A coordinate in units, truncated: the error is below 1 unit, which in the square of 2³¹
    /// is 2³², a part in 2³⁰. Saturates beyond 2³¹ units, which is out of reach. NaN gives 0.
    #[inline(always)]
    fn units(&self, coordinate: f32) -> i32 {
        (coordinate * self.scale) as i32
    }

    #[inline(always)]
    fn rest(&self, x: i32, y: i32) -> f32 {
        let (x, y) = (i64::from(x), i64::from(y));
        let rest = self.square.wrapping_sub((x * x).wrapping_add(y * y));
        (rest >> 32) as i32 as f32 * self.unit
    }
}

/// 2ⁿ for −126 ≤ n ≤ 127.
fn power_of_two(n: i32) -> f32 {
    f32::from_bits(((n + 127) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_difference_of_squares_errs_by_the_last_bits_of_the_square(
            size in -32.0..43.0_f64, share in 0.1..0.9_f64, radius in 0.0..1.0_f64, turn in 0.0..6.3_f64,
            pivot in prop_oneof![Just(0.0), 0.0..1.0_f64],
        ) {
            let sum = libm::exp(size);
            let (first, second) = ((share * sum) as f32, ((1.0 - share) * sum) as f32);
            let sum = f64::from(first) + f64::from(second);
            let (sin, cos) = libm::sincos(turn);
            let pivot = (pivot * sum) as f32;
            let x = (sum * radius * cos) as f32 + pivot;
            let y = (sum * radius * sin) as f32;
            let along = f64::from(x) - f64::from(pivot);
            let exact = sum * sum - along * along - f64::from(y) * f64::from(y);
            let fixed = FixedPointSquare::of_sum(first, second, pivot);
            let error = f64::from(fixed.less_from_pivot(x, y)) - exact;
            if pivot == 0.0 {
                prop_assert_eq!(fixed.less_from_pivot(x, y), fixed.less(x, y));
            }
            // Units of 2⁻³⁰ of the sum and the pivot: each coordinate and the sum may be
            // off by two; half of f32's last bit.
            let unit = (sum + f64::from(pivot)) * 0.5_f64.powi(30);
            let bound = 8.0 * sum * unit + exact.abs() * 0.5_f64.powi(24);
            prop_assert!(error.abs() <= bound, "{error:e} of {exact:e}");
        }
    }

    #[test]
    fn a_point_beyond_the_sum_leaves_less_than_nothing() {
        for first in [0.7_f32, 1.0, 1.999_999] {
            for pivot in [0.0_f32, 0.6, 30.0] {
                let fixed = FixedPointSquare::of_sum(first, 1e-7, pivot);
                for x in [2.0_f32 + pivot, 1e5, 1e30, f32::MAX, f32::INFINITY] {
                    for [x, y] in [[x, 0.0], [-x, -x], [0.1, -x]] {
                        let rest = fixed.less_from_pivot(x, y);
                        assert!(rest < 0.0, "{first} and {x}, {y}: {rest}");
                    }
                }
            }
        }
    }
}
