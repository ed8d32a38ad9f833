//! Dual numbers with several derivatives at once: one evaluation of a model gives a whole gradient.

use fivebar_kinematics::Scalar;
use num_traits::{One, Zero};
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A value and its derivatives with respect to `N` variables: a [`Scalar`] whose arithmetic is, bit by bit, that of `N`
/// times [`Dual`](crate::Dual). Comparisons use the value only.
///
/// ```
/// use fivebar_design::Gradient;
///
/// let (x, y) = (Gradient::<2>::variable(3.0, 0), Gradient::variable(5.0, 1));
/// assert_eq!((x * y * y).derivatives(), [25.0, 30.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gradient<const N: usize> {
    value: f64,
    derivatives: [f64; N],
}

impl<const N: usize> Gradient<N> {
    const fn constant(value: f64) -> Self {
        let derivatives = [0.0; N];
        Self { value, derivatives }
    }

    /// The variable with this index, at this value; a constant where no variable has the index.
    #[inline]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut variable = Self::constant(value);
        if let Some(derivative) = variable.derivatives.get_mut(index) {
            *derivative = 1.0;
        }
        variable
    }

    /// The value.
    #[inline]
    pub fn value(&self) -> f64 {
        self.value
    }

    /// The derivatives.
    #[inline]
    pub fn derivatives(&self) -> [f64; N] {
        self.derivatives
    }

    /// The value with each derivative by this rule.
    #[inline(always)]
    fn by(self, value: f64, rule: impl Fn(f64) -> f64) -> Self {
        let derivatives = self.derivatives.map(rule);
        Self { value, derivatives }
    }

    /// The value with each pair of derivatives by this rule.
    #[inline(always)]
    fn with(self, other: Self, value: f64, rule: impl Fn(f64, f64) -> f64) -> Self {
        let derivatives =
            std::array::from_fn(|index| rule(self.derivatives[index], other.derivatives[index]));
        Self { value, derivatives }
    }
}

/// The rules of products and quotients.
impl<const N: usize> Gradient<N> {
    #[inline]
    fn product(self, other: Self) -> Self {
        self.with(other, self.value * other.value, |a, b| {
            a * other.value + b * self.value
        })
    }

    #[inline]
    fn quotient(self, other: Self) -> Self {
        let inverse = other.value.recip();
        self.with(other, self.value * inverse, |a, b| {
            (a * other.value - b * self.value) * inverse * inverse
        })
    }
}

impl<const N: usize> PartialOrd for Gradient<N> {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<const N: usize> Scalar for Gradient<N> {
    const ZERO: Self = Self::constant(0.0);
    const ONE: Self = Self::constant(1.0);
    const HALF: Self = Self::constant(0.5);
    const TWO: Self = Self::constant(2.0);
    const EPSILON: Self = Self::constant(f64::EPSILON);

    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::constant(value)
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self.value
    }

    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let slope = self.value.recip() * root * 0.5;
        self.by(root, |x| x * slope)
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.by(sin, |x| x * cos), self.by(cos, |x| x * -sin))
    }

    /// d atan2(y, x) = (x dy − y dx)/(x² + y²).
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let norm_squared = self.value * self.value + x.value * x.value;
        self.with(x, self.value.atan2(x.value), |dy, dx| {
            (x.value * dy - self.value * dx) / norm_squared
        })
    }
}

impl<const N: usize> Neg for Gradient<N> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        self.by(-self.value, |x| -x)
    }
}

impl<const N: usize> Add for Gradient<N> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.with(other, self.value + other.value, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Gradient<N> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.with(other, self.value - other.value, |a, b| a - b)
    }
}

impl<const N: usize> Mul for Gradient<N> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        self.product(other)
    }
}

impl<const N: usize> Div for Gradient<N> {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        self.quotient(other)
    }
}

macro_rules! assigning {
    ($($operation:ident $method:ident $of:ident),*) => {$(
        impl<const N: usize> $operation for Gradient<N> {
            #[inline]
            fn $method(&mut self, other: Self) {
                *self = self.$of(other);
            }
        }
    )*};
}

assigning!(AddAssign add_assign add, SubAssign sub_assign sub, MulAssign mul_assign mul, DivAssign div_assign div);

impl<const N: usize> Zero for Gradient<N> {
    fn zero() -> Self {
        Self::ZERO
    }

    /// The derivatives must be 0 too: a variable with the value 0 is different from the constant 0.
    fn is_zero(&self) -> bool {
        *self == Self::ZERO
    }
}

impl<const N: usize> One for Gradient<N> {
    fn one() -> Self {
        Self::ONE
    }
}

#[cfg(test)]
mod tests {
    use super::Gradient;
    use crate::{Dual, Noise};
    use fivebar_kinematics::Scalar;

    /// Every operation, on two numbers of any type.
    fn results<S: Scalar>(a: S, b: S) -> [S; 12] {
        let (sin, cos) = a.sin_cos();
        let (mut sum, mut product) = (a, a);
        sum += b;
        product *= b;
        sum -= sin;
        product /= cos;
        [
            a + b,
            a - b,
            a * b,
            a / b,
            -a,
            (a * a).sqrt(),
            sin,
            cos,
            a.atan2(b),
            b.atan2(a),
            sum,
            product,
        ]
    }

    #[test]
    fn each_operation_has_the_bits_of_two_dual_numbers() {
        let mut noise = Noise::new(53);
        for _ in 0..1000 {
            let (a, b) = (noise.normal(), noise.normal());
            let by_a = results(Dual::variable(a), Dual::constant(b));
            let by_b = results(Dual::constant(a), Dual::variable(b));
            let found = results(Gradient::<2>::variable(a, 0), Gradient::variable(b, 1));
            for (index, found) in found.into_iter().enumerate() {
                let duals = [by_a[index], by_b[index]];
                let bits = |numbers: [f64; 2]| numbers.map(f64::to_bits);
                let values = duals.map(Dual::value);
                assert_eq!(bits([found.value(); 2]), bits(values), "{index}: {a} {b}");
                // A zero may have the other sign: equal, but not in its bits.
                assert_eq!(
                    found.derivatives(),
                    duals.map(Dual::derivative),
                    "{index}: {a} {b}"
                );
            }
        }
    }
}
