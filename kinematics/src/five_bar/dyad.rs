//! Two links from a pivot to a given point: every position solution consists of such dyads.
//!
//! The joint between them is where two circles meet. With the lengths n of the near and f
//! of the far link, s = n + f, d = n − f, and p the point from the pivot:
//!
//! a = ½(1 + s d/|p|²), h = √((s² − |p|²)(|p|² − d²))/(2 |p|²), joint = a p ± h p⊥.
//!
//! Heron's product has two thirds of the rounding error of n²/|p|² − a². p × joint =
//! ±h |p|² is twice the triangle's area, n f times the sine of the angle between the links:
//! the denominator of all their velocities.

use super::Side;
use crate::scalar::FixedPointSquare;
use crate::{PlanarVector, Scalar};
use core::fmt;
use nalgebra::Vector2;

/// Why two links have no unique joint between pivot and point.
///
/// ```
/// use fivebar_kinematics::five_bar::{Dyad, DyadError, Side};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let dyad = Dyad::new(0.3, 0.4); // m
/// let solve = |x: f64| dyad.solve(Vector2::new(x, 0.0), Side::Left);
/// assert_eq!(solve(0.8), Err(DyadError::TooFar));
/// assert_eq!(solve(0.05), Err(DyadError::TooNear));
/// assert!(matches!(solve(0.7), Err(DyadError::InLine(_))));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DyadError<S> {
    /// The links are in line to rounding. This is their joint [m]; their velocities are
    /// undefined.
    InLine(Vector2<S>),
    /// The point is farther from the pivot than the sum of the links.
    TooFar,
    /// The point is nearer to the pivot than the difference of the links.
    TooNear,
    /// The links are equal and the point is the pivot: every direction is a solution.
    Coincident,
    /// An input is infinite or not a number.
    NotFinite,
}

impl<S: Scalar> fmt::Display for DyadError<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::InLine(_) => "the two links are in line",
            Self::TooFar => "the point is farther away than both links reach",
            Self::TooNear => "the point is nearer than the difference of the links",
            Self::Coincident => "the point is on the pivot, and the links are equal",
            Self::NotFinite => "a number given is infinite or not a number",
        })
    }
}

impl<S: Scalar> core::error::Error for DyadError<S> {}

/// Two links of given lengths, with the constants of their solution.
///
/// ```
/// use fivebar_kinematics::five_bar::{Dyad, Side};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// // The right-angled triangle of sides 0.3, 0.4 and 0.5 m.
/// let dyad = Dyad::new(0.3, 0.4);
/// let joint = dyad.joint(Vector2::new(0.5, 0.0), Side::Left)?;
/// assert!((joint - Vector2::new(0.18, 0.24)).norm() < 1e-15);
/// # Ok::<(), fivebar_kinematics::five_bar::DyadError<f64>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dyad<S> {
    near: S,
    far: S,
    /// f² [m²].
    far_squared: S,
    /// s² [m²].
    sum_squared: S,
    /// x of the pivot [m].
    pivot: S,
    /// s² in fixed point, for [`Dyad::solve_precisely`].
    fixed: FixedPointSquare,
    /// d² [m²].
    difference_squared: S,
    /// s d [m²].
    sum_difference: S,
    /// Heron's product below which the links are in line to rounding [m⁴].
    least: S,
}

/// The solution of a dyad between its pivot and a point.
///
/// ```
/// use fivebar_kinematics::five_bar::{Dyad, Side};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let point = Vector2::new(0.5, 0.0);
/// let solution = Dyad::new(0.3, 0.4).solve(point, Side::Right)?;
/// assert!((solution.joint.y + 0.24_f64).abs() < 1e-15);
/// // Twice the area of the triangle, negative on the right of the ray to the point [m²].
/// assert!((solution.cross + 0.12).abs() < 1e-15);
/// # Ok::<(), fivebar_kinematics::five_bar::DyadError<f64>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DyadSolution<S> {
    /// The joint between the links, from the pivot [m].
    pub joint: Vector2<S>,
    /// p × joint [m²], not zero.
    pub cross: S,
}

impl Dyad<f32> {
    /// Without links.
    pub(super) const NONE: Self = Self {
        near: 0.0,
        far: 0.0,
        far_squared: 0.0,
        sum_squared: 0.0,
        pivot: 0.0,
        fixed: FixedPointSquare::NONE,
        difference_squared: 0.0,
        sum_difference: 0.0,
        least: 0.0,
    };
}

impl<S: Scalar> Dyad<S> {
    /// Links of these lengths [m], positive and finite; the near one turns about the pivot.
    pub fn new(near: S, far: S) -> Self {
        Self::at(S::ZERO, near, far)
    }

    /// As [`Dyad::new`], with the pivot at (`pivot`, 0).
    // Called once for each arm, from many places: not inlined, to save flash.
    #[inline(never)]
    pub(super) fn at(pivot: S, near: S, far: S) -> Self {
        let (sum, difference) = (near + far, near - far);
        let (sine, product) = (least_sine_squared(), near * far);
        Self {
            near,
            far,
            pivot,
            far_squared: far * far,
            sum_squared: sum * sum,
            fixed: FixedPointSquare::of_sum(near, far, pivot),
            difference_squared: difference * difference,
            sum_difference: sum * difference,
            // (2 n f sin)².
            least: (product + product) * (product + product) * sine,
        }
    }

    /// Length of the link at the pivot [m].
    #[inline(always)]
    pub(super) fn near(&self) -> S {
        self.near
    }

    /// Length of the other link [m].
    #[inline(always)]
    pub(super) fn far(&self) -> S {
        self.far
    }

    /// f² [m²].
    #[inline(always)]
    pub(super) fn far_squared(&self) -> S {
        self.far_squared
    }

    /// The dyad with its end at `p` from the pivot [m] and its joint on that side of the
    /// ray to `p`.
    ///
    /// # Errors
    /// Where there is no joint or more than one, and where the links are in line to rounding.
    #[inline(always)]
    pub fn solve(&self, p: Vector2<S>, side: Side) -> Result<DyadSolution<S>, DyadError<S>> {
        self.solve_with_gap(p, self.sum_squared - p.length_squared(), side)
    }

    /// As [`Dyad::solve`], with s² − |p|² by [`Scalar::difference_of_squares`]: for a point
    /// that is exact: near a stretched dyad the plain difference would lose its digits.
    #[inline(always)]
    pub(super) fn solve_precisely(
        &self,
        p: Vector2<S>,
        side: Side,
    ) -> Result<DyadSolution<S>, DyadError<S>> {
        let gap = S::difference_of_squares(self.sum_squared, &self.fixed, p.x, p.y);
        self.solve_with_gap(p, gap, side)
    }

    /// As [`Dyad::solve_precisely`], with `point` from the origin. In s² − |p|², the
    /// difference of the point and the pivot is exact; elsewhere it is rounded.
    #[inline(always)]
    pub(super) fn solve_precisely_to(
        &self,
        point: Vector2<S>,
        side: Side,
    ) -> Result<DyadSolution<S>, DyadError<S>> {
        let (square, pivot) = (self.sum_squared, self.pivot);
        let gap = S::difference_of_squares_from_pivot(square, &self.fixed, pivot, point.x, point.y);
        self.solve_with_gap(Vector2::new(point.x - pivot, point.y), gap, side)
    }

    /// One square root and one division. One comparison rejects NaN, unreachable and singular
    /// inputs; [`Dyad::error`] then finds the reason.
    #[inline(always)]
    fn solve_with_gap(
        &self,
        p: Vector2<S>,
        gap: S,
        side: Side,
    ) -> Result<DyadSolution<S>, DyadError<S>> {
        let p_squared = p.length_squared();
        let product = gap * (p_squared - self.difference_squared);
        if product > self.least {
            let half_per_p_squared = S::HALF / p_squared;
            let a = S::HALF + self.sum_difference * half_per_p_squared;
            let h = side.sign(product.sqrt()) * half_per_p_squared;
            Ok(DyadSolution {
                joint: p * a + p.perpendicular() * h,
                cross: h * p_squared,
            })
        } else {
            Err(self.error(p, product, side))
        }
    }

    /// The joint alone [m], from the pivot; links may be in line.
    ///
    /// # Errors
    /// As [`Dyad::solve`], except `InLine`.
    #[inline(always)]
    pub fn joint(&self, p: Vector2<S>, side: Side) -> Result<Vector2<S>, DyadError<S>> {
        Self::joint_of(self.solve(p, side))
    }

    /// The joint of a solution, or of links in line.
    #[inline(always)]
    pub(super) fn joint_of(
        solution: Result<DyadSolution<S>, DyadError<S>>,
    ) -> Result<Vector2<S>, DyadError<S>> {
        // By components: the compiler then keeps them in floating-point registers.
        let [x, y] = match &solution {
            Ok(solution) => [solution.joint.x, solution.joint.y],
            Err(DyadError::InLine(joint)) => [joint.x, joint.y],
            Err(error) => return Err(*error),
        };
        Ok(Vector2::new(x, y))
    }

    /// The joint of links in line, allowing for rounding of 8 ulp of the lengths, or the
    /// reason why there is none.
    #[cold]
    #[inline(never)]
    fn error(&self, p: Vector2<S>, product: S, side: Side) -> DyadError<S> {
        if !(p.x.is_finite() && p.y.is_finite()) {
            return DyadError::NotFinite;
        }
        let half_per_p_squared = S::HALF / p.length_squared();
        let along = p * (S::HALF + self.sum_difference * half_per_p_squared);
        let h = product.sqrt() * half_per_p_squared;
        if h <= coincidence() {
            return DyadError::InLine(along + p.perpendicular() * side.sign(h));
        }
        let distance = p.length();
        let slack = S::from_f64(8.0) * S::EPSILON * (self.near + self.far);
        let least = (self.near - self.far).abs();
        if distance > self.near + self.far + slack {
            DyadError::TooFar
        } else if distance < least - slack {
            DyadError::TooNear
        } else if least <= slack && distance <= slack + slack {
            DyadError::Coincident
        } else {
            DyadError::InLine(along)
        }
    }
}

/// sin² of the angle between links that are in line to rounding.
///
/// A position is known to about ε of its size, a direction near a singularity only to
/// √ε: a sine below 8 √ε (1.2e-7 for `f64`, 2.8e-3 for `f32`) is rounding, and dividing
/// by it would give large numbers without a correct digit.
#[inline(always)]
pub(super) fn least_sine_squared<S: Scalar>() -> S {
    S::from_f64(64.0) * S::EPSILON
}

/// h at which |p| is 16 roundings of the lengths: the direction of p is then lost.
#[inline]
fn coincidence<S: Scalar>() -> S {
    S::ONE / (S::from_f64(16.0) * S::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(
        p: Vector2<f64>,
        near: f64,
        far: f64,
        side: Side,
    ) -> Result<Vector2<f64>, DyadError<f64>> {
        Dyad::new(near, far).joint(p, side)
    }

    fn at(distance: f64, near: f64, far: f64) -> Result<Vector2<f64>, DyadError<f64>> {
        joint(Vector2::new(0.6, 0.8) * distance, near, far, Side::Left)
    }

    #[test]
    fn the_joint_is_at_both_distances_and_on_its_side() {
        for side in Side::BOTH {
            let p = Vector2::new(0.3, -0.1);
            let Ok(closed) = Dyad::new(0.2, 0.25).solve(p, side) else {
                panic!("the point is within reach");
            };
            assert!((closed.joint.length() - 0.2).abs() < 1e-15);
            assert!(((closed.joint - p).length() - 0.25).abs() < 1e-15);
            assert_eq!(Side::of(p.cross_z(closed.joint)), side);
            assert!((p.cross_z(closed.joint) - closed.cross).abs() < 1e-16);
        }
    }

    #[test]
    fn links_in_line_but_for_rounding_meet() {
        for ulps in -4_i32..=4 {
            let nearly = 1.0 + f64::from(ulps) * f64::EPSILON;
            let outside = at(0.5 * nearly, 0.2, 0.3).unwrap();
            assert!((outside.length() - 0.2).abs() < 1e-8);
            let inside = at(0.1 * nearly, 0.2, 0.3).unwrap();
            assert!((inside.length() - 0.2).abs() < 1e-8);
        }
    }

    #[test]
    fn links_in_line_to_rounding_are_told_from_bent_ones() {
        let (near, far) = (0.2_f64, 0.3_f64);
        for (sine, bent) in [(1e-7, false), (1.4e-7, true)] {
            let joint = Vector2::new(near, 0.0);
            let p = joint + Vector2::new(libm::sqrt(1.0 - sine * sine), -sine) * far;
            let closed = Dyad::new(near, far).solve(p, Side::Left);
            assert_eq!(closed.is_ok(), bent, "sine {sine}");
            assert!((Dyad::joint_of(closed).unwrap() - joint).length() < 1e-7);
        }
    }

    #[test]
    fn a_joint_in_line_to_rounding_stays_on_its_side() {
        for side in Side::BOTH {
            let p = Vector2::new(0.3, 0.4) * (1.0 - 4.0 * f64::EPSILON);
            assert!(Dyad::new(0.2, 0.3).solve(p, side).is_err());
            let joint = joint(p, 0.2, 0.3, side).unwrap();
            assert_eq!(Side::of(p.cross_z(joint)), side);
            assert!(p.cross_z(joint).abs() > 1e-10);
        }
    }

    #[test]
    fn equal_links_that_fold_onto_each_other_point_across() {
        let joint = joint(Vector2::new(1e-10, 0.0), 0.2, 0.2, Side::Left).unwrap();
        assert!((joint - Vector2::new(0.0, 0.2)).length() < 1e-9);
    }

    #[test]
    fn every_miss_says_why() {
        assert_eq!(at(0.5 + 1e-12, 0.2, 0.3), Err(DyadError::TooFar));
        assert_eq!(at(1e200, 0.2, 0.3), Err(DyadError::TooFar));
        assert_eq!(at(0.1 - 1e-12, 0.2, 0.3), Err(DyadError::TooNear));
        assert_eq!(at(0.0, 0.2, 0.3), Err(DyadError::TooNear));
        assert_eq!(at(0.0, 0.2, 0.2), Err(DyadError::Coincident));
        assert_eq!(at(1e-17, 0.2, 0.2), Err(DyadError::Coincident));
        assert!(at(1e-12, 0.2, 0.2).is_ok());
        assert_eq!(at(f64::NAN, 0.2, 0.2), Err(DyadError::NotFinite));
        assert_eq!(at(f64::INFINITY, 0.2, 0.2), Err(DyadError::NotFinite));
    }

    #[test]
    fn single_precision_says_the_same_of_every_miss_by_either_way() {
        let dyad = Dyad::new(0.2_f32, 0.3);
        for [x, y] in [
            [0.5_f32 * (1.0 + 2e-6), 0.0],
            [-0.6, 0.3],
            [1e30, -1e30],
            [-1e20, -1e20],
            [0.0, 0.0],
            [0.099_999, 0.0],
            [f32::NAN, 0.1],
            [0.1, f32::NEG_INFINITY],
        ] {
            let p = Vector2::new(x, y);
            let plainly = dyad.solve(p, Side::Left).err();
            let precisely = dyad.solve_precisely(p, Side::Left).err();
            assert!(plainly.is_some(), "at {p:?}");
            assert_eq!(plainly, precisely, "at {p:?}");
        }
    }
}
