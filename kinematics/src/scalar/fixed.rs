//! The square of a length as an integer, to take another from it without loss.

use super::Scalar;

/// The square of the sum of two lengths, in units so small that it is an integer.
///
/// The unit of length is the power of two that puts the sum into 2³⁰…2³¹ units. Good for
/// lengths from 1e-14 to 1e19 m, whose squares `f32` can hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedSquare {
    /// Units per metre.
    scale: f32,
    /// 2³² square units [m²].
    unit: f32,
    /// In square units, below 2⁶².
    square: i64,
}

impl FixedSquare {
    /// Of the sum of two positive lengths.
    pub fn of_sum<S: Scalar>(first: S, second: S) -> Self {
        let (first, second) = (first.to_f64() as f32, second.to_f64() as f32);
        // 2^(e − 127) ≤ the sum < 2^(e − 126).
        let exponent = ((first + second).to_bits() >> 23).clamp(80, 191);
        let scale = power_of_two(30 + 127 - exponent as i32);
        let sum = i64::from((first * scale) as i32) + i64::from((second * scale) as i32);
        Self {
            scale,
            unit: power_of_two(32 - 2 * (30 + 127 - exponent as i32)),
            square: sum * sum,
        }
    }

    /// The square less x² + y² [m²], rounded once.
    ///
    /// x and y in units err by less than one, by which they are too small: the square
    /// of a coordinate of 2³¹ errs by 2³², a part in 2³⁰ of it. Beyond 2³¹ units
    /// coordinates are cut off there, farther than the sum all the same. Not a number
    /// counts as 0.
    #[inline(always)]
    pub(super) fn less(&self, x: f32, y: f32) -> f32 {
        let square = |coordinate: f32| {
            let units = i64::from((coordinate * self.scale) as i32);
            units * units
        };
        let rest = self.square.wrapping_sub(square(x).wrapping_add(square(y)));
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
        ) {
            let sum = libm::exp(size);
            let (first, second) = ((share * sum) as f32, ((1.0 - share) * sum) as f32);
            let sum = f64::from(first) + f64::from(second);
            let (sin, cos) = libm::sincos(turn);
            let (x, y) = ((sum * radius * cos) as f32, (sum * radius * sin) as f32);
            let exact = sum * sum - f64::from(x) * f64::from(x) - f64::from(y) * f64::from(y);
            let error = f64::from(FixedSquare::of_sum(first, second).less(x, y)) - exact;
            // Three cuts of 2⁻²⁸ at most, and half of f32's last bit.
            let bound = 3.0 * sum * sum * 0.5_f64.powi(28) + exact.abs() * 0.5_f64.powi(24);
            prop_assert!(error.abs() <= bound, "{error:e} of {exact:e}");
        }
    }

    #[test]
    fn a_point_beyond_the_sum_leaves_less_than_nothing() {
        for first in [0.7_f32, 1.0, 1.999_999] {
            let fixed = FixedSquare::of_sum(first, 1e-7);
            for x in [2.0_f32, 1e5, 1e30, f32::MAX, f32::INFINITY] {
                for [x, y] in [[x, 0.0], [-x, -x], [0.1, -x]] {
                    assert!(fixed.less(x, y) < 0.0, "{first} and {x}, {y}");
                }
            }
        }
    }
}
