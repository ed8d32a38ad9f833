//! PRP: two sliders on two moving guides, pinned together at P3.
//!
//! P3 = G1 + s1 u1 = G2 + s2 u2, with G the offset e beside each guide's origin. With
//! d = G2 − G1: s1 = d×u2 / (u1×u2), s2 = d×u1 / (u1×u2).
//!
//! The velocities solve the same equations with d = v_G2 − v_G1, the accelerations with
//! d = a_G2 + 2 ω2 ṡ2 n2 − a_G1 − 2 ω1 ṡ1 n1; G1 and G2 are here the guides' points at P3.

use super::{DyadError, DyadMotion, Singular, beside, finite, regular};
use crate::linkage::joint::Joint;
use crate::linkage::motion::{Coordinate, LinkMotion};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Two sliders pinned together. It has one branch only.
///
/// Each slider's frame starts at P3 and keeps its guide's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prp<S> {
    /// e1 and e2, the offsets of the pin to the left of each guide's origin [m].
    pub offsets: [S; 2],
}

impl<S: Scalar> Prp<S> {
    /// s1 and s2 [m], the displacements along the guides.
    ///
    /// # Errors
    /// `Singular` where the guides are parallel.
    #[inline]
    pub fn position(
        &self,
        guide1: &LinkMotion<S>,
        guide2: &LinkMotion<S>,
    ) -> Result<[S; 2], DyadError> {
        finite(&[guide1.origin.position, guide2.origin.position])?;
        let sine = regular(guide1.axis.cross_z(guide2.axis), Singular::GuidesParallel)?;
        let [e1, e2] = self.offsets;
        let d = beside(guide2, e2) - beside(guide1, e1);
        Ok(along(d, guide1.axis, guide2.axis, sine))
    }

    /// Position, velocity and acceleration from those of the guides.
    ///
    /// # Errors
    /// As [`Prp::position`].
    #[inline]
    pub fn motion(
        &self,
        guide1: &LinkMotion<S>,
        guide2: &LinkMotion<S>,
    ) -> Result<DyadMotion<S>, DyadError> {
        let [s1, s2] = self.position(guide1, guide2)?;
        let (u1, u2) = (guide1.axis, guide2.axis);
        let sine = u1.cross_z(u2);
        let p3 = beside(guide1, self.offsets[0]) + u1 * s1;
        let (g1, g2) = (guide1.point_at(p3), guide2.point_at(p3));

        let [rate1, rate2] = along(g2.velocity - g1.velocity, u1, u2, sine);

        let coriolis = |guide: &LinkMotion<S>, rate: S| {
            guide.axis.perpendicular() * (S::TWO * guide.omega * rate)
        };
        let a =
            g2.acceleration + coriolis(guide2, rate2) - g1.acceleration - coriolis(guide1, rate1);
        let [acceleration1, acceleration2] = along(a, u1, u2, sine);

        let slide = |value, rate, acceleration| Coordinate {
            value,
            rate,
            acceleration,
        };
        let slide1 = slide(s1, rate1, acceleration1);
        let slide2 = slide(s2, rate2, acceleration2);
        let inner_point = guide1.slider_motion(&g1, &slide1);
        Ok(DyadMotion {
            links: [
                guide1.with_origin(inner_point),
                guide2.with_origin(inner_point),
            ],
            inner_point,
            slides: [Some(slide1), Some(slide2)],
            joints: [
                Joint::Prismatic { at: p3, axis: u1 },
                Joint::Revolute { at: p3 },
                Joint::Prismatic { at: p3, axis: u2 },
            ],
            sine,
        })
    }
}

/// The two numbers with x1 u1 − x2 u2 = d.
#[inline]
fn along<S: Scalar>(d: Vector2<S>, u1: Vector2<S>, u2: Vector2<S>, sine: S) -> [S; 2] {
    [d.cross_z(u2) / sine, d.cross_z(u1) / sine]
}
