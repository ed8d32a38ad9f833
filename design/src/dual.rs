//! Dual numbers: a value with one derivative, for automatic differentiation.

use fivebar_kinematics::Scalar;
use num_dual::{Dual64, DualNum};
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
}

impl Scalar for Dual {
    const ZERO: Self = const_dual(0.0);
    const ONE: Self = const_dual(1.0);
    const HALF: Self = const_dual(0.5);
    const TWO: Self = const_dual(2.0);
    const EPSILON: Self = const_dual(f64::EPSILON);

    fn from_f64(value: f64) -> Self {
        Self::constant(value)
    }
    fn to_f64(self) -> f64 {
        self.value()
    }
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (Self(sin), Self(cos))
    }
    /// d atan2(y, x) = (x dy − y dx)/(x² + y²). This is finite at x = 0; num-dual
    /// differentiates the quotient y/x, which is infinite there.
    fn atan2(self, x: Self) -> Self {
        let (y, x) = (self.0, x.0);
        let norm_squared = y.re * y.re + x.re * x.re;
        Self::new(
            y.re.atan2(x.re),
            (x.re * y.eps - y.re * x.eps) / norm_squared,
        )
    }
}

/// [`Dual::constant`] for constant expressions.
const fn const_dual(value: f64) -> Dual {
    Dual(Dual64 {
        re: value,
        eps: 0.0,
    })
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Zero for Dual {
    fn zero() -> Self {
        Self::ZERO
    }
    /// The derivative must be 0 too: a variable with the value 0 is different from the constant 0.
    fn is_zero(&self) -> bool {
        self.value() == 0.0 && self.derivative() == 0.0
    }
}

impl One for Dual {
    fn one() -> Self {
        Self::ONE
    }
}

macro_rules! forward_to_num_dual {
    ($($operation:ident $method:ident $assigning:ident $assign:ident),*) => {$(
        impl $operation for Dual {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
        impl $assigning for Dual {
            fn $assign(&mut self, other: Self) {
                *self = self.$method(other);
            }
        }
    )*};
}

forward_to_num_dual!(
    Add add AddAssign add_assign,
    Sub sub SubAssign sub_assign,
    Mul mul MulAssign mul_assign,
    Div div DivAssign div_assign
);

#[cfg(test)]
mod tests {
    use super::Dual;
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
}
