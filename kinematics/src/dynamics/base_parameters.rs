//! The equations of motion in base parameters, for the tick.
//!
//! In Kane's equations, as [`Arm::inverse_dynamics`] evaluates them body by body, masses,
//! centres and inertias occur only in a few sums, the base parameters of the identification
//! literature. They are computed once. With cj the centre of mass and Ij the inertia of link
//! j, the payload mC lumped to link 2 as M2 = m2 + mC, and Jr the rotors',
//!
//! | link | first moment Sj, in the link's frame | second moment Jj, about its proximal joint |
//! |---|---|---|
//! | 1 | m1 c1 + M2 (l1, 0) | I1 + m1 |c1|² + M2 l1² + Jr1 |
//! | 2 | m2 c2 + mC (l2, 0) | I2 + m2 |c2|² + mC l2² |
//! | 3 | m3 c3 | I3 + m3 |c3|² |
//! | 4 | m4 c4 + m3 (l4, 0) | I4 + m4 |c4|² + m3 l4² + Jr4 |
//!
//! Everything else is products of the links rj themselves ([`Links`]), X = r2×r3. With
//! (pj, qj) = Sj/lj, so that Sj turned into the plane is pj rj + qj rj⊥, gravity's moment
//! on link j is rj·Gj with the constant Gj = (Sj×g, −Sj·g)/lj, and
//!
//! ω21 = r3×r1/X, ω24 = −r3×r4/X, ω31 = r2×r1/X, ω34 = −r2×r4/X,
//! ω2 = ω21 ω1 + ω24 ω4, ω3 = ω31 ω1 + ω34 ω4,
//! w = ω1² r1 + ω2² r2 − ω3² r3 − ω4² r4,
//! α2 = ω21 α1 + ω24 α4 + w·r3/X, α3 = ω31 α1 + ω34 α4 + w·r2/X,
//! c12 = p2 r1·r2 + q2 r2×r1, x12 = q2 r1·r2 − p2 r2×r1,
//! c43 = p3 r4·r3 + q3 r3×r4, x43 = q3 r4·r3 − p3 r3×r4,
//! k2 = c12 α1 + x12 ω1² + J2 α2 − r2·G2,
//! k3 = c43 α4 + x43 ω4² + J3 α3 − r3·G3,
//! τ1 = J1 α1 + c12 α2 − x12 ω2² − r1·G1 + ω21 k2 + ω31 k3,
//! τ4 = J4 α4 + c43 α3 − x43 ω3² − r4·G4 + ω24 k2 + ω34 k3.

use super::Arm;
use crate::five_bar::{Links, PartialRates};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The equations of motion of an arm, with its masses as base parameters.
///
/// ```
/// use fivebar_kinematics::dynamics::{Arm, BaseParameterModel, Link};
/// use fivebar_kinematics::five_bar::{Geometry, Links, Side};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(0.06, length)); // kg, m
/// let arm = Arm::new(geometry, rods, 0.03, Vector2::new(0.0, -9.81), [2e-5; 2])?;
///
/// let pose = geometry.forward(2.0, 1.1, Side::Left)?;
/// let velocities = geometry.forward_velocities(&pose, 3.0, -1.0)?; // rad/s
/// let accelerations = geometry.forward_accelerations(&pose, &velocities, 80.0, -20.0)?; // rad/s²
/// let kane = arm.inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())?;
/// let model = BaseParameterModel::new(&arm);
/// let torque = model.torques(&Links::of(&pose, &geometry), [3.0, -1.0], [80.0, -20.0]);
/// assert!(kane[0].abs() > 0.01); // N·m
/// assert!((torque[0] - kane[0]).abs() < 1e-14);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseParameterModel<S> {
    /// (p2, q2), (p3, q3) [kg].
    first: [Vector2<S>; 2],
    /// J1…J4 [kg·m²].
    second: [S; 4],
    /// G1…G4 [N].
    weight: [Vector2<S>; 4],
}

impl<S: Scalar> BaseParameterModel<S> {
    /// The equations of an arm.
    pub fn new(arm: &Arm<S>) -> Self {
        let geometry = arm.geometry();
        let (l1, l2, l3, l4) = (geometry.l1(), geometry.l2(), geometry.l3(), geometry.l4());
        let [link1, link2, link3, link4] = arm.links();
        let [rotor1, rotor4] = arm.rotor_inertia();
        let payload = arm.payload();
        let beyond1 = link2.mass + payload;
        let along = |mass: S| Vector2::new(mass, S::ZERO);
        let per_length = |link: &super::Link<S>, length: S| link.com * (link.mass / length);
        let own = |link: &super::Link<S>| link.inertia + link.mass * link.com.length_squared();
        let first1 = per_length(link1, l1) + along(beyond1);
        let first2 = per_length(link2, l2) + along(payload);
        let first3 = per_length(link3, l3);
        let first4 = per_length(link4, l4) + along(link3.mass);
        let g = arm.gravity();
        Self {
            first: [first2, first3],
            second: [
                own(link1) + beyond1 * l1 * l1 + rotor1,
                own(link2) + payload * l2 * l2,
                own(link3),
                own(link4) + link3.mass * l4 * l4 + rotor4,
            ],
            weight: [first1, first2, first3, first4]
                .map(|first| Vector2::new(first.cross_z(g), -first.dot(&g))),
        }
    }

    /// M11, M14, M44 [kg·m²] of the mass matrix in the driven angles, where the links are: what
    /// [`Arm::mass_matrix`] gives.
    ///
    /// M11 = J1 + 2 c12 ω21 + J2 ω21² + J3 ω31², M44 = J4 + 2 c43 ω34 + J2 ω24² + J3 ω34²,
    /// M14 = c12 ω24 + c43 ω31 + J2 ω21 ω24 + J3 ω31 ω34.
    #[inline(always)]
    pub fn mass(&self, links: &Links<S>) -> [S; 3] {
        let Links {
            ab: r1,
            bc: r2,
            dc: r3,
            ed: r4,
            cross,
        } = *links;
        let per_cross = S::ONE / cross;
        let (cross21, cross34) = (r2.cross_z(r1), r3.cross_z(r4));
        let omega21 = r3.cross_z(r1) * per_cross;
        let omega24 = -cross34 * per_cross;
        let omega31 = cross21 * per_cross;
        let omega34 = r4.cross_z(r2) * per_cross;
        self.mass_by(
            links,
            &PartialRates {
                link2: [omega21, omega24],
                link3: [omega31, omega34],
            },
        )
    }

    /// As [`Self::mass`], where the links' rates are known.
    #[inline(always)]
    pub fn mass_by(&self, links: &Links<S>, rates: &PartialRates<S>) -> [S; 3] {
        let Links {
            ab: r1,
            bc: r2,
            dc: r3,
            ed: r4,
            ..
        } = *links;
        let (cross21, cross34) = (r2.cross_z(r1), r3.cross_z(r4));
        let ([omega21, omega24], [omega31, omega34]) = (rates.link2, rates.link3);
        let [[p2, q2], [p3, q3]] = self.first.map(Into::into);
        let c12 = p2 * r1.dot(&r2) + q2 * cross21;
        let c43 = p3 * r4.dot(&r3) + q3 * cross34;
        let [j1, j2, j3, j4] = self.second;
        let (k21, k31) = (c12 + j2 * omega21, c43 + j3 * omega34);
        [
            j1 + omega21 * (c12 + k21) + j3 * omega31 * omega31,
            omega24 * k21 + omega31 * k31,
            j4 + omega34 * (c43 + k31) + j2 * omega24 * omega24,
        ]
    }

    /// The driving torques [τ1, τ4] [N·m] that hold the arm at rest, where the links' rates are known: what [`Self::torques`]
    /// gives without velocities and accelerations.
    #[inline(always)]
    pub fn gravity_by(&self, links: &Links<S>, rates: &PartialRates<S>) -> [S; 2] {
        let Links {
            ab: r1,
            bc: r2,
            dc: r3,
            ed: r4,
            ..
        } = *links;
        let ([omega21, omega24], [omega31, omega34]) = (rates.link2, rates.link3);
        let [g1, g2, g3, g4] = self.weight;
        let (k2, k3) = (r2.dot(&g2), r3.dot(&g3));
        [
            -(r1.dot(&g1) + omega21 * k2 + omega31 * k3),
            -(r4.dot(&g4) + omega24 * k2 + omega34 * k3),
        ]
    }

    /// The driving torques [τ1, τ4] [N·m] that accelerate the driven joints by `alpha`
    /// [rad/s²] where the links are and at their velocities `omega` [rad/s]: what
    /// [`Arm::inverse_dynamics`] gives without an external force.
    #[inline(always)]
    pub fn torques(&self, links: &Links<S>, omega: [S; 2], alpha: [S; 2]) -> [S; 2] {
        let Links {
            ab: r1,
            bc: r2,
            dc: r3,
            ed: r4,
            cross,
        } = *links;
        let ([omega1, omega4], [alpha1, alpha4]) = (omega, alpha);
        let per_cross = S::ONE / cross;

        let (cross21, cross34) = (r2.cross_z(r1), r3.cross_z(r4));
        let omega21 = r3.cross_z(r1) * per_cross;
        let omega24 = -cross34 * per_cross;
        let omega31 = cross21 * per_cross;
        let omega34 = r4.cross_z(r2) * per_cross;
        let omega2 = omega21 * omega1 + omega24 * omega4;
        let omega3 = omega31 * omega1 + omega34 * omega4;

        let (square1, square2) = (omega1 * omega1, omega2 * omega2);
        let (square3, square4) = (omega3 * omega3, omega4 * omega4);
        let w = r1 * square1 + r2 * square2 - r3 * square3 - r4 * square4;
        let alpha2 = omega21 * alpha1 + omega24 * alpha4 + w.dot(&r3) * per_cross;
        let alpha3 = omega31 * alpha1 + omega34 * alpha4 + w.dot(&r2) * per_cross;

        let [[p2, q2], [p3, q3]] = self.first.map(Into::into);
        let (dot12, dot43) = (r1.dot(&r2), r4.dot(&r3));
        let (c12, x12) = (p2 * dot12 + q2 * cross21, q2 * dot12 - p2 * cross21);
        let (c43, x43) = (p3 * dot43 + q3 * cross34, q3 * dot43 - p3 * cross34);
        let [j1, j2, j3, j4] = self.second;
        let [g1, g2, g3, g4] = self.weight;
        // Gravity's moments by components: each then takes one instruction less.
        let k2 = c12 * alpha1 + x12 * square1 + j2 * alpha2 - r2.x * g2.x - r2.y * g2.y;
        let k3 = c43 * alpha4 + x43 * square4 + j3 * alpha3 - r3.x * g3.x - r3.y * g3.y;
        [
            j1 * alpha1 + c12 * alpha2 - x12 * square2 - r1.x * g1.x - r1.y * g1.y
                + omega21 * k2
                + omega31 * k3,
            j4 * alpha4 + c43 * alpha3 - x43 * square3 - r4.x * g4.x - r4.y * g4.y
                + omega24 * k2
                + omega34 * k3,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Link;
    use crate::five_bar::{Geometry, Side};
    use proptest::prelude::*;

    proptest! {
        /// Where the links' rates are known, gravity is what the torques are at rest, and the mass matrix what they add.
        #[test]
        fn known_rates_give_the_parts_of_the_torques(
            theta1 in 1.2..2.8_f64, theta4 in 0.2..1.8_f64, alpha in prop::array::uniform2(-50.0..50.0_f64),
        ) {
            let geometry = Geometry::new([0.10, 0.16, 0.15, 0.11, 0.08]).unwrap();
            let links = [0.10, 0.16, 0.15, 0.11].map(|length| Link {
                com: Vector2::new(0.4 * length, 0.1 * length),
                ..Link::uniform_rod(0.06, length)
            });
            let arm = Arm::new(geometry, links, 0.03, Vector2::new(1.0, -9.81), [2e-5; 2]).unwrap();
            let model = BaseParameterModel::new(&arm);
            let [u1, u4] = Vector2::units([theta1, theta4]);
            let links = geometry.links(u1, u4, Side::Left);
            prop_assume!(links.is_ok_and(|links| links.cross.abs() > 0.004));
            let links = links.unwrap();
            let rates = links.partial_rates();
            let (gravity, [m11, m14, m44]) = (model.gravity_by(&links, &rates), model.mass_by(&links, &rates));
            let (rest, torque) = (model.torques(&links, [0.0; 2], [0.0; 2]), model.torques(&links, [0.0; 2], alpha));
            let sum = [
                gravity[0] + m11 * alpha[0] + m14 * alpha[1],
                gravity[1] + m14 * alpha[0] + m44 * alpha[1],
            ];
            for joint in 0..2 {
                prop_assert!((gravity[joint] - rest[joint]).abs() < 1e-12);
                prop_assert!((sum[joint] - torque[joint]).abs() < 1e-10);
                prop_assert!(rest[joint].abs() > 1e-6);
            }
        }
    }
}
