//! The equations of motion regrouped for the tick: each mass parameter once.
//!
//! In Kane's equations, as [`Arm::inverse_dynamics`] evaluates them body by body, masses,
//! centres and inertias come up only in a few sums (the base parameters of the
//! identification literature). Those are made here once: with cj the centre of mass and
//! Ij the inertia of link j, the payload mC lumped to link 2 as M2 = m2 + mC, and Jr the
//! rotors',
//!
//! | link | first moment Sj, in the link's frame | second moment Jj, about its proximal joint |
//! |---|---|---|
//! | 1 | m1 c1 + M2 (l1, 0) | I1 + m1 |c1|² + M2 l1² + Jr1 |
//! | 2 | m2 c2 + mC (l2, 0) | I2 + m2 |c2|² + mC l2² |
//! | 3 | m3 c3 | I3 + m3 |c3|² |
//! | 4 | m4 c4 + m3 (l4, 0) | I4 + m4 |c4|² + m3 l4² + Jr4 |
//!
//! With sj = Sj turned to uj, c12 = l1 u1·s2, x12 = l1 u1×s2, c43 = l4 u4·s3,
//! x43 = l4 u4×s3, and the partial angular velocities of links 2 and 3:
//!
//! k2 = c12 α1 + x12 ω1² + J2 α2 − s2×g,
//! k3 = c43 α4 + x43 ω4² + J3 α3 − s3×g,
//! τ1 = J1 α1 + c12 α2 − x12 ω2² − s1×g + ω21 k2 + ω31 k3,
//! τ4 = J4 α4 + c43 α3 − x43 ω3² − s4×g + ω24 k2 + ω34 k3.

use super::Arm;
use crate::five_bar::{Geometry, Pose, PoseError};
use crate::{Scalar, Vec2};

/// An arm's equations of motion, its masses summed up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regrouped<S> {
    geometry: Geometry<S>,
    gravity: Vec2<S>,
    /// S1…S4 [kg·m].
    first: [Vec2<S>; 4],
    /// J1…J4 [kg·m²].
    second: [S; 4],
}

impl<S: Scalar> Regrouped<S> {
    /// The equations of an arm.
    pub fn new(arm: &Arm<S>) -> Self {
        let geometry = *arm.geometry();
        let (l1, l2, l4) = (geometry.l1(), geometry.l2(), geometry.l4());
        let [link1, link2, link3, link4] = arm.links();
        let [rotor1, rotor4] = arm.rotor_inertia();
        let payload = arm.payload();
        let beyond1 = link2.mass + payload;
        let along = |moment: S| Vec2::new(moment, S::ZERO);
        let own = |link: &super::Link<S>| link.inertia + link.mass * link.com.norm_squared();
        Self {
            geometry,
            gravity: arm.gravity(),
            first: [
                link1.com * link1.mass + along(beyond1 * l1),
                link2.com * link2.mass + along(payload * l2),
                link3.com * link3.mass,
                link4.com * link4.mass + along(link3.mass * l4),
            ],
            second: [
                own(link1) + beyond1 * l1 * l1 + rotor1,
                own(link2) + payload * l2 * l2,
                own(link3),
                own(link4) + link3.mass * l4 * l4 + rotor4,
            ],
        }
    }

    /// The driving torques [τ1, τ4] [N·m] that accelerate the driven joints by `alpha`
    /// [rad/s²] at a pose and their velocities `omega` [rad/s]: what
    /// [`Arm::inverse_dynamics`] gives without an external force.
    ///
    /// # Errors
    /// `Singular` at type 2.
    #[inline(always)]
    pub fn torques(
        &self,
        pose: &Pose<S>,
        omega: [S; 2],
        alpha: [S; 2],
    ) -> Result<[S; 2], PoseError> {
        let geometry = &self.geometry;
        let (l1, l2, l3, l4) = (geometry.l1(), geometry.l2(), geometry.l3(), geometry.l4());
        let Pose { u1, u2, u3, u4, .. } = *pose;
        let ([omega1, omega4], [alpha1, alpha4]) = (omega, alpha);
        let g = self.gravity;

        let [per2, per3] = geometry.per_sine32(pose)?;
        let omega21 = l1 * u3.cross(u1) * per2;
        let omega24 = -l4 * u3.cross(u4) * per2;
        let omega31 = l1 * u2.cross(u1) * per3;
        let omega34 = -l4 * u2.cross(u4) * per3;
        let omega2 = omega21 * omega1 + omega24 * omega4;
        let omega3 = omega31 * omega1 + omega34 * omega4;

        // α2 and α3: the driven joints' share and the centripetal one.
        let (square1, square2) = (omega1 * omega1, omega2 * omega2);
        let (square3, square4) = (omega3 * omega3, omega4 * omega4);
        let [e1, e2, e3, e4] = [l1 * square1, l2 * square2, l3 * square3, l4 * square4];
        let cos32 = u2.dot(u3);
        let alpha2 = omega21 * alpha1
            + omega24 * alpha4
            + (e1 * u1.dot(u3) - e4 * u4.dot(u3) + e2 * cos32 - e3) * per2;
        let alpha3 = omega31 * alpha1
            + omega34 * alpha4
            + (e1 * u1.dot(u2) - e4 * u4.dot(u2) - e3 * cos32 + e2) * per3;

        let [s1, s2, s3, s4] = self.first;
        let (s1, s2) = (s1.rotated_to(u1), s2.rotated_to(u2));
        let (s3, s4) = (s3.rotated_to(u3), s4.rotated_to(u4));
        let [j1, j2, j3, j4] = self.second;
        let (c12, x12) = (l1 * u1.dot(s2), l1 * u1.cross(s2));
        let (c43, x43) = (l4 * u4.dot(s3), l4 * u4.cross(s3));
        let k2 = c12 * alpha1 + x12 * square1 + j2 * alpha2 - s2.cross(g);
        let k3 = c43 * alpha4 + x43 * square4 + j3 * alpha3 - s3.cross(g);
        Ok([
            j1 * alpha1 + c12 * alpha2 - x12 * square2 - s1.cross(g) + omega21 * k2 + omega31 * k3,
            j4 * alpha4 + c43 * alpha3 - x43 * square3 - s4.cross(g) + omega24 * k2 + omega34 * k3,
        ])
    }
}
