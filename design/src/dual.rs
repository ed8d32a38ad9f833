//! Dual numbers: a value with one derivative, or with second ones, for automatic differentiation.

use fivebar_kinematics::Scalar;
use num_dual::{Dual64, DualNum, HyperDual64};
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A value and its derivative with respect to one variable: a [`Scalar`] for sensitivities.
///
/// The arithmetic is that of num-dual. Comparisons use the value only.
///
/// ```
/// use fivebar_design::Dual;
/// use fivebar_kinematics::five_bar::{Geometry, Side};
///
/// // ∂C.x/∂l2 [m/m].
/// let [l1, l3, l4, base] = [0.1, 0.16, 0.11, 0.08].map(Dual::constant);
/// let geometry = Geometry::new([l1, Dual::variable(0.15), l3, l4, base])?;
/// let pose = geometry.forward(Dual::constant(2.0), Dual::constant(1.1), Side::Left)?;
/// assert!(pose.c.x.derivative().abs() > 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Dual(Dual64);

impl Dual {
    /// A number that does not depend on the variable.
    pub fn constant(value: f64) -> Self {
        Self::new(value, 0.0)
    }

    /// The variable itself, at this value.
    pub fn variable(value: f64) -> Self {
        Self::new(value, 1.0)
    }

    /// A number with its derivative with respect to the variable.
    pub fn new(value: f64, derivative: f64) -> Self {
        Self(Dual64::new(value, derivative))
    }

    /// The value.
    pub fn value(self) -> f64 {
        self.0.re
    }

    /// The derivative with respect to the variable.
    pub fn derivative(self) -> f64 {
        self.0.eps
    }

    /// d atan2(y, x) = (x dy − y dx)/(x² + y²). This is finite at x = 0; num-dual
    /// differentiates the quotient y/x, which is infinite there.
    fn angle(x: Self, y: Self) -> Self {
        let (y, x) = (y.0, x.0);
        let norm_squared = y.re * y.re + x.re * x.re;
        Self::new(
            y.re.atan2(x.re),
            (x.re * y.eps - y.re * x.eps) / norm_squared,
        )
    }
}

/// A value with its derivatives by two variables and the second derivative by both: a [`Scalar`] for Hessians.
///
/// ```
/// use fivebar_design::HyperDual;
///
/// // ∂²(x y²)/∂x∂y = 2 y.
/// let (x, y) = (HyperDual::new(3.0, [1.0, 0.0]), HyperDual::new(5.0, [0.0, 1.0]));
/// assert_eq!((x * y * y).second(), 10.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct HyperDual(HyperDual64);

impl HyperDual {
    /// A number with its derivatives by both variables, linear in these.
    pub fn new(value: f64, [first, second]: [f64; 2]) -> Self {
        Self(HyperDual64::new(value, first, second, 0.0))
    }

    /// The value.
    pub fn value(self) -> f64 {
        self.0.re
    }

    /// The derivatives by the first and by the second variable.
    pub fn first(self) -> [f64; 2] {
        [self.0.eps1, self.0.eps2]
    }

    /// The derivative by both variables, the second one if both are the same.
    pub fn second(self) -> f64 {
        self.0.eps1eps2
    }

    /// The angle of the vector's value, and the arctangent of the vector turned back by it, whose quotient is
    /// 0: finite at x = 0, too.
    fn angle(x: Self, y: Self) -> Self {
        let (angle, length) = (y.0.re.atan2(x.0.re), y.0.re.hypot(x.0.re));
        let (sin, cos) = (Self::of(y.0.re / length), Self::of(x.0.re / length));
        let quotient = (y * cos - x * sin) / (x * cos + y * sin);
        let turned = quotient.0.atan();
        Self(HyperDual64 {
            re: angle,
            ..turned
        })
    }
}

/// What both types have of num-dual: its arithmetic, roots, sines and cosines.
macro_rules! number_of_num_dual {
    ($number:ident, $inner:ident { $($part:ident),* }) => {
        impl $number {
            /// [`Scalar::from_f64`] for constant expressions.
            const fn of(value: f64) -> Self {
                Self($inner { re: value, $($part: 0.0),* })
            }
        }

        impl Scalar for $number {
            const ZERO: Self = Self::of(0.0);
            const ONE: Self = Self::of(1.0);
            const HALF: Self = Self::of(0.5);
            const TWO: Self = Self::of(2.0);
            const EPSILON: Self = Self::of(f64::EPSILON);

            fn from_f64(value: f64) -> Self {
                Self::of(value)
            }
            fn to_f64(self) -> f64 {
                self.0.re
            }
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            fn sin_cos(self) -> (Self, Self) {
                let (sin, cos) = self.0.sin_cos();
                (Self(sin), Self(cos))
            }
            fn atan2(self, x: Self) -> Self {
                Self::angle(x, self)
            }
        }

        impl Neg for $number {
            type Output = Self;
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Zero for $number {
            fn zero() -> Self {
                Self::ZERO
            }
            /// The derivatives must be 0 too: a variable with the value 0 is different from the constant 0.
            fn is_zero(&self) -> bool {
                *self == Self::ZERO
            }
        }

        impl One for $number {
            fn one() -> Self {
                Self::ONE
            }
        }

        number_of_num_dual!(@operations $number:
            Add add AddAssign add_assign,
            Sub sub SubAssign sub_assign,
            Mul mul MulAssign mul_assign,
            Div div DivAssign div_assign
        );
    };
    (@operations $number:ident: $($operation:ident $method:ident $assigning:ident $assign:ident),*) => {$(
        impl $operation for $number {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
        impl $assigning for $number {
            fn $assign(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
    )*};
}

number_of_num_dual!(Dual, Dual64 { eps });
number_of_num_dual!(
    HyperDual,
    HyperDual64 {
        eps1,
        eps2,
        eps1eps2
    }
);

#[cfg(test)]
mod tests {
    use super::{Dual, HyperDual};
    use fivebar_kinematics::Scalar;
    use fivebar_kinematics::five_bar::{Geometry, Side};

    /// The x coordinate of C as a function of l2, with the other lengths fixed.
    fn c_x<S: Scalar>(l2: S) -> S {
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
            let angle = Dual::constant(y).atan2(Dual::variable(0.0));
            assert_eq!(angle.derivative(), -1.0 / y);
        }
    }

    #[test]
    fn a_derivative_flows_through_the_forward_solution() {
        let exact = c_x(Dual::variable(0.15));
        let step = 1e-6;
        let difference = (c_x(0.15 + step) - c_x(0.15 - step)) / (2.0 * step);
        assert_eq!(exact.value(), c_x(0.15));
        assert!(exact.derivative().abs() > 0.1);
        assert!((exact.derivative() - difference).abs() < 1e-8 * exact.derivative().abs());
    }

    #[test]
    fn second_derivatives_of_an_angle_are_those_of_the_closed_form_also_upright() {
        for [x, y] in [[0.3, 0.4], [0.0, 2.0], [-1.5, -0.2], [0.0, -0.5]] {
            let (q, both) = (x * x + y * y, [[1.0, 0.0], [0.0, 1.0]]);
            let by = |i: usize, j: usize| {
                let [dx, dy] = [0, 1].map(|axis| [both[i][axis], both[j][axis]]);
                HyperDual::new(y, dy).atan2(HyperDual::new(x, dx)).second()
            };
            let q2 = q * q;
            for (found, expected) in [
                (by(0, 0), 2.0 * x * y / q2),
                (by(1, 1), -2.0 * x * y / q2),
                (by(0, 1), (y * y - x * x) / q2),
            ] {
                assert!(
                    (found - expected).abs() < 1e-13 / q,
                    "{x} {y}: {found} {expected}"
                );
            }
        }
    }
}
