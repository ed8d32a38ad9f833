//! `f32`: the controller's number, with its own sine, cosine and arctangent.
//!
//! Only IEEE additions, multiplications, divisions and square roots, never fused, so
//! that a desktop and a Cortex-M4F give the same bits. The polynomials are minimax fits
//! (Remez); every stated bound is asserted by the tests below.

use super::{FixedPointSquare, Scalar};

impl Scalar for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;
    const HALF: Self = 0.5;
    const TWO: Self = 2.0;
    const EPSILON: Self = f32::EPSILON;

    #[inline]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        square_root(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
    #[inline(always)]
    fn xor_sign(self, sign_bit: u32) -> Self {
        Self::from_bits(self.to_bits() ^ sign_bit)
    }
    #[inline(always)]
    fn sin_cos_both([first, second]: [Self; 2]) -> [(Self, Self); 2] {
        let (first, second) = (reduced(first), reduced(second));
        [first.turned(), second.turned()]
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        atan2(self, x)
    }
    #[inline(always)]
    fn difference_of_squares(_: Self, fixed: &FixedPointSquare, x: Self, y: Self) -> Self {
        fixed.less(x, y)
    }
    #[inline(always)]
    fn difference_of_squares_from_pivot(
        _: Self,
        fixed: &FixedPointSquare,
        _: Self,
        x: Self,
        y: Self,
    ) -> Self {
        fixed.less_from_pivot(x, y)
    }
    #[inline]
    fn abs(self) -> Self {
        self.abs()
    }
}

/// (sin x, cos x).
///
/// With k = round(2x/π) and r = x − kπ/2, |r| ≤ π/4 (Cody–Waite):
/// sin r = r + r³ S(r²), cos r = 1 − r² (½ − r² C(r²)), swapped and signed by k mod 4.
///
/// Errors for |x| ≤ 6283 rad, a thousand turns:
///
/// | from | sin r | cos r |
/// |---|---|---|
/// | the fits, |r| ≤ 0.786 | 2e-9 | 1e-10 |
/// | rounding r, 2⁻²⁵ | 3.0e-8 | 2.1e-8 |
/// | rounding the terms | 1.5e-8 | 3.8e-8 |
/// | rounding the last sum, 2⁻²⁵ | 3.0e-8 | 3.0e-8 |
/// | together | 8e-8 | 9e-8 |
///
/// The quadrant may swap them: both results are within 9e-8.
///
/// Beyond, the error is at most |x|·2⁻²³, the distance between neighbours of x. From 2²⁰ rad
/// on, neighbours are an eighth of a radian apart: the result has no correct digit and may
/// exceed 1. An infinite angle or NaN gives NaN.
#[inline(always)]
fn sin_cos(x: f32) -> (f32, f32) {
    reduced(x).turned()
}

/// An angle within an eighth of a turn of a whole number of quarter turns.
struct Reduced {
    /// The quarter turns k: its last two bits.
    quadrant: u32,
    /// sin r.
    sin: f32,
    /// cos r.
    cos: f32,
}

#[inline(always)]
fn reduced(x: f32) -> Reduced {
    // 1.5·2²³: adding it rounds to an integer, whose last bits are then the sum's.
    const ROUND: f32 = 12_582_912.0;
    // π/2 = C1 + C2. C1 has 12 bits, so that k C1 is exact for |k| < 2¹²; C2 carries
    // the rest to 2⁻⁴³, and its product's rounding is below 1e-9 for such k.
    const C1: f32 = 3217.0 / 2048.0;
    const C2: f32 = -4.454_455e-6;

    let shifted = x * core::f32::consts::FRAC_2_PI + ROUND;
    let quadrant = shifted.to_bits();
    let k = shifted - ROUND;
    let r = (x - k * C1) - k * C2;
    let z = r * r;

    let s = (-1.949_495e-4 * z + 8.331_973e-3) * z - 0.166_666_51;
    let c = (2.443_773e-5 * z - 1.388_736_2e-3) * z + 4.166_664_6e-2;
    Reduced {
        quadrant,
        sin: r + r * z * s,
        cos: 1.0 - z * (0.5 - z * c),
    }
}

impl Reduced {
    /// k quarter turns back.
    #[inline(always)]
    fn turned(&self) -> (f32, f32) {
        match self.quadrant & 3 {
            0 => (self.sin, self.cos),
            1 => (self.cos, -self.sin),
            2 => (-self.sin, -self.cos),
            _ => (-self.cos, self.sin),
        }
    }
}

/// The angle of the finite vector (x, y) in (−π, π]; 0 for the zero vector.
///
/// It has the sign of y. Of (x, |y|) it is atan t with t = |y|/x about the positive x axis,
/// π/2 + atan t with t = −x/|y| about the y axis, and π + atan t with t = |y|/x about the
/// negative x axis, each within 45°, so that |t| ≤ 1 and atan t = t + t³ P(t²).
///
/// Errors: the fit 5e-8; rounding t ≤ 2.4e-8, the terms ≤ 3.9e-8, their sum ≤ 3e-8;
/// rounding the correction by the low part of π/2 or π ≤ 3e-8 and the last sum ≤ 1.2e-7
/// (half the distance of neighbours beyond 2 rad): together below 3e-7 rad.
#[inline]
fn atan2(y: f32, x: f32) -> f32 {
    // π/2 = HI + LO.
    const HI: f32 = core::f32::consts::FRAC_PI_2;
    const LO: f32 = -4.371_139e-8;

    let size = y.abs();
    let (t, high, low) = if size > x.abs() {
        (-x / size, HI, LO)
    } else if x > 0.0 {
        (size / x, 0.0, 0.0)
    } else if x < 0.0 {
        (size / x, 2.0 * HI, 2.0 * LO)
    } else {
        return 0.0;
    };
    let z = t * t;
    let p = -4.355_393_5e-3;
    let p = p * z + 2.304_008_8e-2;
    let p = p * z - 5.777_352e-2;
    let p = p * z + 9.794_23e-2;
    let p = p * z - 0.139_765_8;
    let p = p * z + 0.199_627_04;
    let p = p * z - 0.333_316_6;
    let angle = high + (low + (t + t * z * p));
    if y < 0.0 { -angle } else { angle }
}

/// √x by the FPU's own instruction, for which `core` has no stable intrinsic.
///
/// The one use of `unsafe` in this crate. It is sound because the instruction reads one register,
/// writes another, touches no memory, and traps for no input.
#[cfg(all(target_arch = "arm", target_abi = "eabihf", target_os = "none"))]
#[inline(always)]
#[allow(unsafe_code)]
fn square_root(x: f32) -> f32 {
    let root: u32;
    // SAFETY: see above; the target has the FPU.
    unsafe {
        core::arch::asm!(
            "vmov s0, {x}",
            "vsqrt.f32 s0, s0",
            "vmov {root}, s0",
            x = in(reg) x.to_bits(),
            root = lateout(reg) root,
            out("s0") _,
            options(pure, nomem, nostack, preserves_flags)
        );
    }
    f32::from_bits(root)
}

/// √x, correctly rounded, as the FPU's own instruction rounds it.
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf", target_os = "none")))]
#[inline]
fn square_root(x: f32) -> f32 {
    libm::sqrtf(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of sine and cosine over `count` angles spread evenly up to ±`limit`.
    fn worst_sin_cos(limit: f64, count: u32) -> (f64, f64) {
        let mut worst = (0.0_f64, 0.0_f64);
        for i in 0..=count {
            let x = (limit * (2.0 * f64::from(i) / f64::from(count) - 1.0)) as f32;
            let (sin, cos) = sin_cos(x);
            let (true_sin, true_cos) = libm::sincos(f64::from(x));
            worst.0 = worst.0.max((f64::from(sin) - true_sin).abs());
            worst.1 = worst.1.max((f64::from(cos) - true_cos).abs());
        }
        worst
    }

    #[test]
    fn sine_and_cosine_keep_their_bounds_within_a_thousand_turns() {
        for limit in [0.9, 7.0, 1000.0, 6283.0] {
            let (sin, cos) = worst_sin_cos(limit, 500_000);
            assert!(sin.max(cos) <= 9e-8, "to {limit} rad: {sin:e}, {cos:e}");
        }
    }

    #[test]
    fn sine_and_cosine_err_by_less_than_neighbouring_angles_differ_beyond() {
        for limit in [1e4_f64, 1e5, 1e6] {
            let (sin, cos) = worst_sin_cos(limit, 100_000);
            let bound = limit * 0.5_f64.powi(23);
            assert!(sin.max(cos) <= bound, "to {limit} rad: {sin:e}, {cos:e}");
        }
    }

    #[test]
    fn sine_and_cosine_of_quarter_turns_and_of_no_number() {
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        for k in -4000..=4000_i16 {
            let x = f32::from(k) * core::f32::consts::FRAC_PI_2;
            let (sin, cos) = sin_cos(x);
            let norm = sin * sin + cos * cos;
            assert!((norm - 1.0).abs() <= 2e-7, "at {x}");
        }
        for x in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            let (sin, cos) = sin_cos(x);
            assert!(sin.is_nan() && cos.is_nan());
        }
    }

    #[test]
    fn arctangent_keeps_its_bound_in_every_direction_and_at_every_size() {
        let count = 1_000_000;
        let mut worst = 0.0_f64;
        for i in 0..count {
            let angle = core::f64::consts::TAU * (f64::from(i) / f64::from(count) - 0.5);
            let (sin, cos) = libm::sincos(angle);
            // From far below any length to far above.
            let size = [1.0, 1e-30, 0.1, 1e30][i as usize % 4];
            let (y, x) = ((size * sin) as f32, (size * cos) as f32);
            let truth = libm::atan2(f64::from(y), f64::from(x));
            worst = worst.max((f64::from(atan2(y, x)) - truth).abs());
        }
        assert!(worst <= 3e-7, "{worst:e} rad");
    }

    #[test]
    fn arctangent_of_the_axes() {
        use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
        assert_eq!(atan2(0.0, 0.0), 0.0);
        assert_eq!(atan2(0.0, 2.0), 0.0);
        assert_eq!(atan2(2.0, 0.0), FRAC_PI_2);
        assert_eq!(atan2(-2.0, 0.0), -FRAC_PI_2);
        assert_eq!(atan2(0.0, -2.0), PI);
        assert_eq!(atan2(-0.0, -2.0), PI, "the range is (−π, π]");
        assert!((atan2(-3.0, 3.0) + FRAC_PI_4).abs() <= 6e-8);
    }

    #[test]
    fn square_root_is_correctly_rounded() {
        let mut x = 1e-38_f32;
        while x < 1e38 {
            // The root of an f32 in f64, rounded once more, is the correctly rounded f32.
            assert_eq!(square_root(x), libm::sqrt(f64::from(x)) as f32, "√{x}");
            x *= 1.001;
        }
        assert_eq!(square_root(0.0), 0.0);
        assert!(square_root(-1.0).is_nan());
    }
}
