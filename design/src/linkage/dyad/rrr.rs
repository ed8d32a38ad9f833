//! RRR: two bars between two moving points, meeting in a pin P3.
//!
//! P3 = P1 + r1 = P2 + r2, |r1| = l1, |r2| = l2. With X = r1×r2 (WUT):
//!
//! ω1 = (Ṗ2−Ṗ1)·r2 / X, ω2 = (Ṗ2−Ṗ1)·r1 / X,
//! (E,F) = P̈2 − P̈1 + ω1² r1 − ω2² r2, α1 = (E,F)·r2 / X, α2 = (E,F)·r1 / X.

use super::{DyadError, DyadMotion, Singular, Unreachable, finite, regular};
use crate::linkage::joint::Joint;
use crate::linkage::motion::{LinkMotion, PointMotion};
use fivebar_kinematics::five_bar::Side;
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Two bars that meet in a pin.
///
/// Each link's frame starts at its end, its x axis pointing to the pin.
///
/// ```
/// use fivebar_design::linkage::dyad::Rrr;
/// use fivebar_kinematics::five_bar::Side;
/// use nalgebra::Vector2;
///
/// // A right-angled triangle of sides 0.3, 0.4 and 0.5 m.
/// let dyad = Rrr { lengths: [0.3, 0.4], side: Side::Left };
/// let pin = dyad.position(Vector2::zeros(), Vector2::new(0.5, 0.0))?;
/// assert!((pin - Vector2::new(0.18, 0.24)).norm() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrr<S> {
    /// l1 and l2 [m].
    pub lengths: [S; 2],
    /// `Left` where P3 lies left of the ray P1→P2.
    pub side: Side,
}

impl<S: Scalar> Rrr<S> {
    /// P3 by the triangle on the base d = P2 − P1: foot a = ½(1 + (l1² − l2²)/|d|²),
    /// height h = √(l1²/|d|² − a²), P3 = P1 + a d ± h d⊥.
    ///
    /// # Errors
    /// `Unreachable` where the bars cannot meet, `Singular` where the ends coincide.
    #[inline]
    pub fn position(&self, p1: Vector2<S>, p2: Vector2<S>) -> Result<Vector2<S>, DyadError> {
        let (d, d_squared) = self.base(p1, p2)?;
        let [l1, l2] = self.lengths;
        let inverse = S::ONE / d_squared;
        let a = S::HALF * (S::ONE + (l1 * l1 - l2 * l2) * inverse);
        let h_squared = l1 * l1 * inverse - a * a;
        if h_squared < S::ZERO {
            return Err(self.too_far_or_near(d_squared));
        }
        Ok(p1 + d * a + d.perpendicular() * self.side.sign(h_squared.sqrt()))
    }

    /// P3 by the vector loop P1 + l1 u1 = P2 + l2 u2 (WUT's second method): u1 eliminated,
    /// A sin θ2 + B cos θ2 + C = 0 with A = 2 d l2 sin ω, B = 2 d l2 cos ω,
    /// C = d² + l2² − l1² and ω the angle of P1→P2; θ2 = 2 atan[(A ± √(A²+B²−C²))/(B−C)].
    ///
    /// It uses atan2 in place of the lecture's rule for negative x, so that B = C is no
    /// special case. It loses digits where A ± √ and B − C both cancel;
    /// [`Rrr::position`] does not.
    ///
    /// # Errors
    /// As [`Rrr::position`].
    pub fn position_by_vector_loop(
        &self,
        p1: Vector2<S>,
        p2: Vector2<S>,
    ) -> Result<Vector2<S>, DyadError> {
        let (d, d_squared) = self.base(p1, p2)?;
        let [l1, l2] = self.lengths;
        let a = S::TWO * l2 * d.y;
        let b = S::TWO * l2 * d.x;
        let c = d_squared + l2 * l2 - l1 * l1;
        let radicand = a * a + b * b - c * c;
        if radicand < S::ZERO {
            return Err(self.too_far_or_near(d_squared));
        }
        let root = self.side.sign(radicand.sqrt());
        let theta2 = S::TWO * (a + root).atan2(b - c);
        Ok(p2 + Vector2::unit(theta2) * l2)
    }

    /// Position, velocity and acceleration from those of the ends.
    ///
    /// # Errors
    /// As [`Rrr::position`]; `Singular` where the bars are in line.
    #[inline]
    pub fn motion(
        &self,
        end1: &PointMotion<S>,
        end2: &PointMotion<S>,
    ) -> Result<DyadMotion<S>, DyadError> {
        let [l1, l2] = self.lengths;
        let p3 = self.position(end1.position, end2.position)?;
        let r1 = p3 - end1.position;
        let r2 = p3 - end2.position;
        let (u1, u2) = (r1 * (S::ONE / l1), r2 * (S::ONE / l2));
        let sine = regular(u1.cross_z(u2), Singular::BarsInLine)?;
        let per_x = S::ONE / (l1 * l2 * sine);

        let v = end2.velocity - end1.velocity;
        let omega1 = v.dot(&r2) * per_x;
        let omega2 = v.dot(&r1) * per_x;

        let ef =
            end2.acceleration - end1.acceleration + r1 * (omega1 * omega1) - r2 * (omega2 * omega2);
        let link = |origin: &PointMotion<S>, axis, omega, alpha| LinkMotion {
            origin: *origin,
            axis,
            omega,
            alpha,
        };
        let link1 = link(end1, u1, omega1, ef.dot(&r2) * per_x);
        let link2 = link(end2, u2, omega2, ef.dot(&r1) * per_x);
        Ok(DyadMotion {
            links: [link1, link2],
            inner_point: link1.point_at(p3),
            slides: [None, None],
            joints: [
                Joint::Revolute { at: end1.position },
                Joint::Revolute { at: p3 },
                Joint::Revolute { at: end2.position },
            ],
            sine,
        })
    }

    /// d = P2 − P1 and |d|²; an error if a coordinate is not finite or if P1 = P2.
    #[inline]
    fn base(&self, p1: Vector2<S>, p2: Vector2<S>) -> Result<(Vector2<S>, S), DyadError> {
        finite(&[p1, p2])?;
        let d = p2 - p1;
        let d_squared = d.length_squared();
        if d_squared > S::ZERO {
            return Ok((d, d_squared));
        }
        let [l1, l2] = self.lengths;
        Err(if l1 == l2 {
            DyadError::Singular(Singular::EndsMeet)
        } else {
            DyadError::Unreachable(Unreachable::EndsTooNear)
        })
    }

    fn too_far_or_near(&self, d_squared: S) -> DyadError {
        let [l1, l2] = self.lengths;
        DyadError::Unreachable(if d_squared > l1 * l1 + l2 * l2 {
            Unreachable::EndsTooFar
        } else {
            Unreachable::EndsTooNear
        })
    }
}
