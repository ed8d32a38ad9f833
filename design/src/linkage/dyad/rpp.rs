//! RPP: a bar that pivots at P1 and slides in a slider, which runs on a moving guide.
//!
//! P1 = K + s u + t w, with K the guide's origin, u its direction and w = u turned by the
//! constant angle between the two slides: s = (P1−K)×w / (u×w), t = u×(P1−K) / (u×w).
//!
//! With v_G, a_G the motion of the guide's point at P1, the velocities solve the same
//! equations with Ṗ1 − v_G, the accelerations with P̈1 − a_G − 2 ω (ṡ u + ṫ w)⊥.
//!
//! Neither link turns relative to the guide. An offset of either slide would only shift
//! the zeros of s and t, so there is none.

use super::{DyadError, DyadMotion, Singular, finite, regular};
use crate::linkage::joint::Joint;
use crate::linkage::motion::{Coordinate, LinkMotion, PointMotion};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// A bar that slides in a slider. It has one branch only.
///
/// The bar's frame starts at P1, its x axis along w; the slider's frame starts at K + s u
/// and keeps the guide's direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rpp<S> {
    /// The bar's direction as a unit vector in the guide's frame.
    pub direction: Vector2<S>,
}

impl<S: Scalar> Rpp<S> {
    /// s and t [m], the displacements of the slider along the guide and of P1 along the bar.
    ///
    /// # Errors
    /// `Singular` where the two slides are parallel.
    #[inline]
    pub fn position(&self, p1: Vector2<S>, guide: &LinkMotion<S>) -> Result<[S; 2], DyadError> {
        finite(&[p1, guide.origin.position])?;
        let w = self.direction.to_base_frame(guide.axis);
        let sine = regular(guide.axis.cross_z(w), Singular::GuidesParallel)?;
        Ok(along(p1 - guide.origin.position, guide.axis, w, sine))
    }

    /// Position, velocity and acceleration from those of the end and the guide.
    ///
    /// # Errors
    /// As [`Rpp::position`].
    #[inline]
    pub fn motion(
        &self,
        end: &PointMotion<S>,
        guide: &LinkMotion<S>,
    ) -> Result<DyadMotion<S>, DyadError> {
        let [s, t] = self.position(end.position, guide)?;
        let u = guide.axis;
        let w = self.direction.to_base_frame(u);
        let sine = u.cross_z(w);
        let g = guide.point_at(end.position);

        let v = end.velocity - g.velocity;
        let [s_rate, t_rate] = along(v, u, w, sine);

        // ṡ u + ṫ w is v itself.
        let coriolis = v.perpendicular() * (S::TWO * guide.omega);
        let [s_acceleration, t_acceleration] =
            along(end.acceleration - g.acceleration - coriolis, u, w, sine);

        let slide = |value, rate, acceleration| Coordinate {
            value,
            rate,
            acceleration,
        };
        let slide_s = slide(s, s_rate, s_acceleration);
        let slide_t = slide(t, t_rate, t_acceleration);
        let q = guide.origin.position + u * s;
        let slider = guide.slider_at(&slide_s);
        let bar = LinkMotion {
            origin: *end,
            axis: w,
            ..slider
        };
        Ok(DyadMotion {
            links: [bar, slider],
            inner_point: slider.origin,
            slides: [Some(slide_s), Some(slide_t)],
            joints: [
                Joint::Revolute { at: end.position },
                Joint::Prismatic { at: q, axis: w },
                Joint::Prismatic { at: q, axis: u },
            ],
            sine,
        })
    }
}

/// The two numbers with x u + y w = d.
#[inline]
fn along<S: Scalar>(d: Vector2<S>, u: Vector2<S>, w: Vector2<S>, sine: S) -> [S; 2] {
    [d.cross_z(w) / sine, u.cross_z(d) / sine]
}
