//! The numbers of several arms side by side: one instruction computes them all. Each lane has the bits that a number by
//! itself has.

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, Scalar};
use num_traits::{One, Zero};
use std::array::from_fn;
use std::f64::consts::FRAC_2_PI;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A bit for each lane.
pub(crate) type Mask = u8;

/// What the equations of the chain compute with.
pub trait Real:
    Scalar
    + Copy
    + Zero
    + One
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
    + Neg<Output = Self>
{
    /// All lanes.
    const ALL: Mask;

    /// The same number in each lane.
    fn each(number: f64) -> Self;

    /// Sine and cosine, those of libm: it gives the same bits on every platform, so that a seed gives the same run everywhere.
    fn sin_cos(self) -> (Self, Self);

    /// The greater one.
    fn max(self, other: Self) -> Self;

    /// The lanes that are −bound to bound.
    fn within(self, bound: f64) -> Mask;

    /// The lanes of `other` that are in the mask, and the rest of its own.
    fn with(self, other: Self, mask: Mask) -> Self;
}

impl Real for f64 {
    const ALL: Mask = 1;

    #[inline(always)]
    fn each(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.max(other)
    }

    #[inline(always)]
    fn within(self, bound: f64) -> Mask {
        Mask::from(self.abs() <= bound)
    }

    #[inline(always)]
    fn with(self, other: Self, mask: Mask) -> Self {
        if mask == 0 { self } else { other }
    }
}

/// A number of each of `N` arms, 8 at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lanes<const N: usize>(pub(crate) [f64; N]);

impl<const N: usize> Lanes<N> {
    #[inline(always)]
    fn by(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        Self(from_fn(|lane| of(self.0[lane], other.0[lane])))
    }
}

impl<const N: usize> Real for Lanes<N> {
    const ALL: Mask = Mask::MAX >> (8 - N);

    #[inline(always)]
    fn each(number: f64) -> Self {
        Self([number; N])
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        if N == 1 || !self.0.iter().fold(true, |all, &x| all & is_common(x)) {
            let both = self.0.map(libm::sincos);
            return (Self(both.map(|both| both.0)), Self(both.map(|both| both.1)));
        }
        // A loop: the functions of `core` that map arrays are not compiled with more instructions than the least.
        let (mut sin, mut cos) = (self, self);
        for lane in 0..N {
            (sin.0[lane], cos.0[lane]) = common_sin_cos(self.0[lane]);
        }
        (sin, cos)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.by(other, f64::max)
    }

    #[inline(always)]
    fn within(self, bound: f64) -> Mask {
        (0..N).fold(0, |mask, lane| mask | self.0[lane].within(bound) << lane)
    }

    #[inline(always)]
    fn with(self, other: Self, mask: Mask) -> Self {
        Self(from_fn(|lane| {
            self.0[lane].with(other.0[lane], mask >> lane & 1)
        }))
    }
}

/// 1.5 · 2⁵²: a number that is added to it and taken away again is rounded to an integer, whose last bits its own then are.
const TO_INTEGER: f64 = 1.5 / f64::EPSILON;
const QUARTERS_PER_RADIAN: f64 = FRAC_2_PI;
/// π/2 in two parts, the first with 33 bits.
const QUARTER: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];

/// Whether [`common_sin_cos`] has the bits of libm: the angle is of some turns, not at the border of two quarters, and not so
/// near the middle of one that libm takes more digits of π.
#[inline(always)]
fn is_common(x: f64) -> bool {
    let quarters = x * QUARTERS_PER_RADIAN;
    let whole = (quarters + TO_INTEGER) - TO_INTEGER;
    let rest = (quarters - whole).abs();
    let is_exact = (rest > 2e-3) | ((whole == 0.0) & (rest > 1e-7));
    is_exact & (rest < 0.4999) & (x.abs() < 64.0)
}

/// The sine and the cosine of libm (FreeBSD's `k_sin` and `k_cos` after an argument reduction in one round), without branches.
#[inline(always)]
fn common_sin_cos(x: f64) -> (f64, f64) {
    let shifted = x * QUARTERS_PER_RADIAN + TO_INTEGER;
    let whole = shifted - TO_INTEGER;
    let quarter = shifted.to_bits();
    let (high, low) = (x - whole * QUARTER[0], whole * QUARTER[1]);
    let y = high - low;
    let rest = (high - y) - low;
    let (sin, cos) = (sine(y, rest, whole == 0.0), cosine(y, rest));
    let is_odd = quarter & 1 == 1;
    let (sin, cos) = if is_odd { (cos, sin) } else { (sin, cos) };
    let signed =
        |number: f64, quarter: u64| f64::from_bits(number.to_bits() ^ ((quarter & 2) << 62));
    (signed(sin, quarter), signed(cos, quarter.wrapping_add(1)))
}

#[inline(always)]
fn sine(x: f64, rest: f64, is_first: bool) -> f64 {
    const S: [f64; 6] = [
        -1.666_666_666_666_663_2e-1,
        8.333_333_333_322_49e-3,
        -1.984_126_982_985_795e-4,
        2.755_731_370_707_006_8e-6,
        -2.505_076_025_340_686_3e-8,
        1.589_690_995_211_55e-10,
    ];
    let z = x * x;
    let w = z * z;
    let r = S[1] + z * (S[2] + z * S[3]) + z * w * (S[4] + z * S[5]);
    let v = z * x;
    let first = x + v * (S[0] + z * r);
    let other = x - ((z * (0.5 * rest - v * r) - rest) - v * S[0]);
    if is_first { first } else { other }
}

#[inline(always)]
fn cosine(x: f64, rest: f64) -> f64 {
    const C: [f64; 6] = [
        4.166_666_666_666_66e-2,
        -1.388_888_888_887_411e-3,
        2.480_158_728_947_673e-5,
        -2.755_731_435_139_066_3e-7,
        2.087_572_321_298_175e-9,
        -1.135_964_755_778_819_5e-11,
    ];
    let z = x * x;
    let w = z * z;
    let r = z * (C[0] + z * (C[1] + z * C[2])) + w * w * (C[3] + z * (C[4] + z * C[5]));
    let half = 0.5 * z;
    let w = 1.0 - half;
    w + (((1.0 - w) - half) + (z * r - x * rest))
}

/// An operator of each lane.
macro_rules! operators {
    ($($name:ident $method:ident $assign:ident $assigned:ident $sign:tt),*) => {$(
        impl<const N: usize> $name for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.by(other, |a, b| a $sign b)
            }
        }

        impl<const N: usize> $assign for Lanes<N> {
            #[inline(always)]
            fn $assigned(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    )*};
}
operators! {
    Add add AddAssign add_assign +,
    Sub sub SubAssign sub_assign -,
    Mul mul MulAssign mul_assign *,
    Div div DivAssign div_assign /
}

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(Neg::neg))
    }
}

impl<const N: usize> Zero for Lanes<N> {
    #[inline(always)]
    fn zero() -> Self {
        Self::each(0.0)
    }

    fn is_zero(&self) -> bool {
        *self == Self::zero()
    }
}

impl<const N: usize> One for Lanes<N> {
    #[inline(always)]
    fn one() -> Self {
        Self::each(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::{Lanes, Real, is_common};
    use fivebar_design::Noise;
    use std::f64::consts::FRAC_PI_4;

    /// Sines and cosines beside those of libm, bit for bit; returns how many angles are common.
    fn compared(angles: [f64; 4]) -> usize {
        let (sin, cos) = Lanes(angles).sin_cos();
        for (lane, angle) in angles.into_iter().enumerate() {
            let expected = libm::sincos(angle);
            let found = (sin.0[lane], cos.0[lane]);
            assert_eq!(
                (found.0.to_bits(), found.1.to_bits()),
                (expected.0.to_bits(), expected.1.to_bits()),
                "{angle:e}"
            );
        }
        angles.into_iter().filter(|&angle| is_common(angle)).count()
    }

    #[test]
    fn sines_have_the_bits_of_libm() {
        let mut noise = Noise::new(1);
        let common: usize = (0..250_000)
            .map(|i| {
                let range = [0.8, 7.0, 63.0, 70.0, 1e3][i % 5];
                compared([0; 4].map(|_| range * (2.0 * noise.uniform() - 1.0)))
            })
            .sum();
        assert!(common > 600_000, "{common}");
    }

    #[test]
    fn sines_at_borders_and_at_whole_quarters_have_the_bits_of_libm() {
        for eighths in -170..=170 {
            let angle = f64::from(eighths) * FRAC_PI_4;
            for digits in 1..=16 {
                let near = 10_f64.powi(-digits);
                compared([angle, angle + near, angle - near, 0.3]);
                // All of them common, if one is.
                for near in [angle + near, angle - near, near, -near] {
                    compared([near; 4]);
                }
            }
        }
        compared([0.0, -0.0, f64::MIN_POSITIVE, 1e300]);
    }

    #[test]
    fn a_mask_has_a_bit_for_each_lane() {
        let numbers = Lanes([0.5, -2.0, f64::NAN, -1.0]);
        assert_eq!(numbers.within(1.0), 0b1001);
        let mixed = Lanes::<4>::each(1.0).with(Lanes([5.0, 6.0, 7.0, 8.0]), 0b0110);
        assert_eq!(mixed.0, [1.0, 6.0, 7.0, 1.0]);
        assert_eq!(Lanes::<4>::ALL, 0b1111);
    }
}
