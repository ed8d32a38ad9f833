//! Where two circles meet: the one construction behind every position solution.

use super::Side;
use crate::{Scalar, Vec2};

/// Why two circles have no point in common, or no definite one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Miss {
    /// The centres are farther apart than the sum of the radii.
    TooFar,
    /// The centres are nearer than the difference of the radii.
    TooNear,
    /// Equal circles: every point is common.
    Coincident,
    /// An input is infinite or not a number.
    NotFinite,
}

/// The point at distance `near` from the origin and `far` from `p`, on that side of the
/// ray from the origin to `p`.
///
/// With s = near + far, d = near − far: a = ½(1 + s d/|p|²),
/// h = √((s² − |p|²)(|p|² − d²))/(2 |p|²), point = a p ± h p⊥.
///
/// Heron's product in place of near²/|p|² − a² loses a third less to rounding. One square
/// root, one division, and one test that nothing but a good answer passes, since a
/// negative product has no root: what is wrong is found out only after it failed.
#[inline(always)]
pub(crate) fn intersect<S: Scalar>(
    p: Vec2<S>,
    near: S,
    far: S,
    side: Side,
) -> Result<Vec2<S>, Miss> {
    let p_squared = p.norm_squared();
    let half_per_p_squared = S::HALF / p_squared;
    let (sum, difference) = (near + far, near - far);
    let a = S::HALF + sum * difference * half_per_p_squared;
    let product = (sum * sum - p_squared) * (p_squared - difference * difference);
    let h = product.sqrt() * half_per_p_squared;
    if h <= coincidence() {
        Ok(p * a + p.perp() * side.sign(h))
    } else {
        touch(p, near, far, a)
    }
}

/// h at which |p| is 16 roundings of the radius: the direction of p is then lost.
#[inline]
fn coincidence<S: Scalar>() -> S {
    S::ONE / (S::from_f64(16.0) * S::EPSILON)
}

/// The point where the circles touch, allowing for rounding of 8 ulp of the radii, or
/// the reason why they do not.
#[cold]
#[inline(never)]
fn touch<S: Scalar>(p: Vec2<S>, near: S, far: S, a: S) -> Result<Vec2<S>, Miss> {
    if !(p.x.is_finite() && p.y.is_finite()) {
        return Err(Miss::NotFinite);
    }
    let distance = p.norm();
    let slack = S::from_f64(8.0) * S::EPSILON * (near + far);
    let least = (near - far).abs();
    if distance > near + far + slack {
        Err(Miss::TooFar)
    } else if distance < least - slack {
        Err(Miss::TooNear)
    } else if least <= slack && distance <= slack + slack {
        Err(Miss::Coincident)
    } else {
        Ok(p * a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(distance: f64, near: f64, far: f64) -> Result<Vec2<f64>, Miss> {
        intersect(Vec2::new(0.6, 0.8) * distance, near, far, Side::Left)
    }

    #[test]
    fn the_point_is_at_both_distances_and_on_its_side() {
        for side in Side::BOTH {
            let p = Vec2::new(0.3, -0.1);
            let point = intersect(p, 0.2, 0.25, side).unwrap();
            assert!((point.norm() - 0.2).abs() < 1e-15);
            assert!(((point - p).norm() - 0.25).abs() < 1e-15);
            assert_eq!(Side::of(p.cross(point)), side);
        }
    }

    #[test]
    fn circles_that_touch_but_for_rounding_meet() {
        for ulps in -4_i32..=4 {
            let nearly = 1.0 + f64::from(ulps) * f64::EPSILON;
            let outside = at(0.5 * nearly, 0.2, 0.3).unwrap();
            assert!((outside.norm() - 0.2).abs() < 1e-8);
            let inside = at(0.1 * nearly, 0.2, 0.3).unwrap();
            assert!((inside.norm() - 0.2).abs() < 1e-8);
        }
    }

    #[test]
    fn every_miss_says_why() {
        assert_eq!(at(0.5 + 1e-12, 0.2, 0.3), Err(Miss::TooFar));
        assert_eq!(at(1e200, 0.2, 0.3), Err(Miss::TooFar));
        assert_eq!(at(0.1 - 1e-12, 0.2, 0.3), Err(Miss::TooNear));
        assert_eq!(at(0.0, 0.2, 0.3), Err(Miss::TooNear));
        assert_eq!(at(0.0, 0.2, 0.2), Err(Miss::Coincident));
        assert_eq!(at(1e-17, 0.2, 0.2), Err(Miss::Coincident));
        assert!(at(1e-12, 0.2, 0.2).is_ok());
        assert_eq!(at(f64::NAN, 0.2, 0.2), Err(Miss::NotFinite));
        assert_eq!(at(f64::INFINITY, 0.2, 0.2), Err(Miss::NotFinite));
    }
}
