//! Functions of numbers that planning needs beyond [`Scalar`]'s.

use crate::Scalar;

/// The lesser of two numbers.
#[inline]
pub(super) fn min<S: Scalar>(a: S, b: S) -> S {
    if b < a { b } else { a }
}

/// The greater of two numbers.
#[inline]
pub(super) fn max<S: Scalar>(a: S, b: S) -> S {
    if b > a { b } else { a }
}

/// ∛x for x ≥ 0.
///
/// ⅓ = ¼ + 1/16 + 1/64 + …, so repeated fourth roots multiply up to ∛x. Six of them leave
/// a factor x^(1/12288), an error under 1 % for any f32 that occurs here. Each of the three
/// Newton steps squares that error.
pub(super) fn cube_root<S: Scalar>(x: S) -> S {
    if x <= S::ZERO {
        return S::ZERO;
    }
    let mut root = S::ONE;
    let mut factor = x;
    for _ in 0..6 {
        factor = factor.sqrt().sqrt();
        root *= factor;
    }
    for _ in 0..3 {
        root = root - (root - x / (root * root)) * S::from_f64(1.0 / 3.0);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::cube_root;

    #[test]
    fn cube_roots_cube_back() {
        for exponent in -30..30 {
            let x = 1.7_f64 * libm::pow(10.0, f64::from(exponent) / 2.0);
            let root = cube_root(x);
            assert!((root * root * root / x - 1.0).abs() < 1e-14, "{x}");
        }
        assert_eq!(cube_root(0.0_f64), 0.0);
        assert!((cube_root(27.0_f32) - 3.0).abs() < 1e-6);
    }
}
