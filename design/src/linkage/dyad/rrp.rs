//! RRP: a bar from a moving point to a slider P3 on a moving guide.
//!
//! P3 = P1 + r = G + s u, |r| = l, where G lies the offset e beside the guide's origin,
//! u is the guide's direction, n = u⊥ and ω its angular velocity. With w = G − P1:
//!
//! s = −w·u ± √(l² − (w·n)²).
//!
//! With v_G, a_G the motion of the guide's point at P3:
//!
//! Ṗ1 + ω1 r⊥ = v_G + ṡ u: ω1 = (v_G − Ṗ1)·n / (r·u), ṡ = (Ṗ1 − v_G)·r / (r·u);
//! P̈1 + α1 r⊥ − ω1² r = a_G + 2 ω ṡ n + s̈ u is solved in the same way.

use super::{DyadError, DyadMotion, Singular, SlideBranch, Unreachable, beside, finite, regular};
use crate::linkage::joint::Joint;
use crate::linkage::motion::{Coordinate, LinkMotion, PointMotion};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// A bar and a slider pinned to its end.
///
/// The bar's frame starts at P1, its x axis pointing to the slider; the slider's frame
/// starts at P3 and keeps the guide's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrp<S> {
    /// l, the bar [m].
    pub length: S,
    /// e, the offset of the slider's pin to the left of the guide's origin [m].
    pub offset: S,
    /// Which of the two positions on the guide.
    pub branch: SlideBranch,
}

impl<S: Scalar> Rrp<S> {
    /// s [m], the slider's displacement along the guide.
    ///
    /// # Errors
    /// `Unreachable` where the bar does not reach the guide.
    #[inline]
    pub fn position(&self, p1: Vector2<S>, guide: &LinkMotion<S>) -> Result<S, DyadError> {
        finite(&[p1, guide.origin.position])?;
        let w = beside(guide, self.offset) - p1;
        let distance = w.dot(&guide.axis.perpendicular());
        let radicand = self.length * self.length - distance * distance;
        if radicand < S::ZERO {
            return Err(DyadError::Unreachable(Unreachable::GuideTooFar));
        }
        Ok(self.branch.sign(radicand.sqrt()) - w.dot(&guide.axis))
    }

    /// Position, velocity and acceleration from those of the end and the guide.
    ///
    /// # Errors
    /// As [`Rrp::position`]; `Singular` where the bar is perpendicular to the guide.
    #[inline]
    pub fn motion(
        &self,
        end: &PointMotion<S>,
        guide: &LinkMotion<S>,
    ) -> Result<DyadMotion<S>, DyadError> {
        let s = self.position(end.position, guide)?;
        let u = guide.axis;
        let n = u.perpendicular();
        let p3 = beside(guide, self.offset) + u * s;
        let r = p3 - end.position;
        let axis = r * (S::ONE / self.length);
        let sine = regular(axis.dot(&u), Singular::BarPerpendicularToGuide)?;
        let per_ru = S::ONE / (self.length * sine);
        let g = guide.point_at(p3);

        let v = g.velocity - end.velocity;
        let omega1 = v.dot(&n) * per_ru;
        let s_rate = -v.dot(&r) * per_ru;

        let a = g.acceleration + n * (S::TWO * guide.omega * s_rate) - end.acceleration
            + r * (omega1 * omega1);
        let slide = Coordinate {
            value: s,
            rate: s_rate,
            acceleration: -a.dot(&r) * per_ru,
        };
        let inner_point = guide.slider_motion(&g, &slide);
        let bar = LinkMotion {
            origin: *end,
            axis,
            omega: omega1,
            alpha: a.dot(&n) * per_ru,
        };
        Ok(DyadMotion {
            links: [bar, guide.with_origin(inner_point)],
            inner_point,
            slides: [Some(slide), None],
            joints: [
                Joint::Revolute { at: end.position },
                Joint::Revolute { at: p3 },
                Joint::Prismatic { at: p3, axis: u },
            ],
            sine,
        })
    }
}
