//! Dual numbers: the desktop's number with one derivative carried along.

use super::Scalar;
use num_dual::{Dual64, DualNum};

impl Scalar for Dual64 {
    const ZERO: Self = Self { re: 0.0, eps: 0.0 };
    const ONE: Self = Self { re: 1.0, eps: 0.0 };
    const HALF: Self = Self { re: 0.5, eps: 0.0 };
    const TWO: Self = Self { re: 2.0, eps: 0.0 };
    const EPSILON: Self = Self {
        re: f64::EPSILON,
        eps: 0.0,
    };

    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::from_re(value)
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self.re
    }
    #[inline]
    fn sqrt(self) -> Self {
        DualNum::sqrt(&self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        DualNum::sin_cos(&self)
    }
    /// d atan2(y, x) = (x dy − y dx)/(x² + y²): finite at x = 0, where the quotient y/x that
    /// num-dual differentiates is not.
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let (y, norm_squared) = (self, self.re * self.re + x.re * x.re);
        Self {
            re: y.re.atan2(x.re),
            eps: (x.re * y.eps - y.re * x.eps) / norm_squared,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::five_bar::{Geometry, Side};
    use num_dual::Dual64;

    /// The tool of a pose as a function of one length, the others fixed.
    fn tool_x<S: crate::Scalar>(l2: S) -> S {
        let fixed = S::from_f64;
        let geometry = Geometry::new([fixed(0.1), l2, fixed(0.16), fixed(0.11), fixed(0.08)]);
        let pose = geometry
            .unwrap()
            .forward(fixed(2.0), fixed(1.1), Side::Left);
        pose.unwrap().c.x
    }

    #[test]
    fn the_angle_of_an_upright_vector_has_a_derivative() {
        for y in [2.0, -2.0] {
            let x = Dual64::from_re(0.0).derivative();
            let angle = crate::Scalar::atan2(Dual64::from_re(y), x);
            assert_eq!(angle.eps, -1.0 / y);
        }
    }

    #[test]
    fn a_derivative_flows_through_the_forward_solution() {
        let exact = tool_x(Dual64::from_re(0.15).derivative());
        let step = 1e-6;
        let difference = (tool_x(0.15 + step) - tool_x(0.15 - step)) / (2.0 * step);
        assert_eq!(exact.re, tool_x(0.15));
        assert!(exact.eps.abs() > 0.1);
        assert!((exact.eps - difference).abs() < 1e-8 * exact.eps.abs());
    }
}
