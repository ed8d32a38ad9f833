//! Kane's equations: partial velocities and inverse dynamics.
//!
//! Generalised speeds ω1, ω4; sij = sin(θi−θj). Partial angular velocities:
//!
//! ω21 = −l1 s13/(l2 s23), ω24 = l4 s43/(l2 s23), ω31 = l1 s12/(l3 s32), ω34 = l4 s24/(l3 s32).
//!
//! τr + F·vCr + Σj mj g·vjr = Σj [mj aj·vjr + Ij αj ωjr] + rotor inertia, r ∈ {1, 4}.
//!
//! With fj = mj (aj − g), the force on link j, and the partial velocities written out, the
//! sums factor link by link. The code has this order.
//!
//! **Errata** of the print: v31 has a superfluous X21; "a = v̇" by components loses the
//! velocity-product terms, which the accelerations must hold.

use super::Arm;
use crate::five_bar::{Accelerations, Pose, PoseError, Singularity, Velocities, per_sine};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Partial angular velocities of links 2 and 3 in the generalised speeds ω1 and ω4.
///
/// ```
/// use fivebar_kinematics::dynamics::{Arm, Link};
/// use fivebar_kinematics::five_bar::{Geometry, Side};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(0.06, length)); // kg, m
/// let arm = Arm::new(geometry, rods, 0.0, Vector2::zeros(), [0.0; 2])?;
/// let pose = geometry.forward(2.0, 1.1, Side::Left)?;
///
/// // ω2 is linear in the generalised speeds ω1 = 3 and ω4 = −1 rad/s.
/// let partial = arm.partial_velocities(&pose)?;
/// let [_, omega2, ..] = geometry.forward_velocities(&pose, 3.0, -1.0)?.omega;
/// assert!((3.0 * partial.omega21 - partial.omega24 - omega2).abs() < 1e-14);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartialVelocities<S> {
    /// ∂ω2/∂ω1.
    pub omega21: S,
    /// ∂ω2/∂ω4.
    pub omega24: S,
    /// ∂ω3/∂ω1.
    pub omega31: S,
    /// ∂ω3/∂ω4.
    pub omega34: S,
}

impl<S: Scalar> Arm<S> {
    /// The partial angular velocities at a pose.
    ///
    /// # Errors
    /// `Singular` at type 2.
    #[inline]
    pub fn partial_velocities(&self, pose: &Pose<S>) -> Result<PartialVelocities<S>, PoseError> {
        let geometry = self.geometry();
        let per_sin32 = per_sine(pose.sin32(), Singularity::Parallel)?;
        let [_, per_l2, per_l3, _] = geometry.per_length();
        let (per2, per3) = (per_l2 * per_sin32, per_l3 * per_sin32);
        Ok(PartialVelocities {
            omega21: geometry.l1() * pose.u3.cross_z(pose.u1) * per2,
            omega24: -geometry.l4() * pose.u3.cross_z(pose.u4) * per2,
            omega31: geometry.l1() * pose.u2.cross_z(pose.u1) * per3,
            omega34: -geometry.l4() * pose.u2.cross_z(pose.u4) * per3,
        })
    }

    /// The driving torques [τ1, τ4] [N·m] that give these accelerations, with
    /// `external_force` [N] acting on C. Without friction.
    ///
    /// # Errors
    /// `Singular` at type 2.
    #[inline]
    pub fn inverse_dynamics(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        accelerations: &Accelerations<S>,
        external_force: Vector2<S>,
    ) -> Result<[S; 2], PoseError> {
        let partial = self.partial_velocities(pose)?;
        let geometry = self.geometry();
        let LinkForces {
            f2,
            f3,
            fc,
            k1,
            k2,
            k3,
            k4,
            ..
        } = self.link_forces(pose, velocities, accelerations, external_force);
        let [alpha1, _, _, alpha4] = accelerations.alpha;
        let [rotor1, rotor4] = self.rotor_inertia();
        Ok([
            k1 + (pose.u1 * geometry.l1()).cross_z(f2 + fc)
                + partial.omega21 * k2
                + partial.omega31 * k3
                + rotor1 * alpha1,
            k4 + (pose.u4 * geometry.l4()).cross_z(f3)
                + partial.omega24 * k2
                + partial.omega34 * k3
                + rotor4 * alpha4,
        ])
    }

    /// The forces and moments that accelerate each link against gravity.
    #[inline]
    pub(super) fn link_forces(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        accelerations: &Accelerations<S>,
        external_force: Vector2<S>,
    ) -> LinkForces<S> {
        let geometry = self.geometry();
        let g = self.gravity();
        let [omega1, omega2, omega3, omega4] = velocities.omega;
        let [alpha1, alpha2, alpha3, alpha4] = accelerations.alpha;
        let [link1, link2, link3, link4] = self.links();

        // Centres of mass from their links' proximal joints, turned into the plane.
        let r1 = link1.com.to_base_frame(pose.u1);
        let r2 = link2.com.to_base_frame(pose.u2);
        let r3 = link3.com.to_base_frame(pose.u3);
        let r4 = link4.com.to_base_frame(pose.u4);
        let ab = turning(pose.u1 * geometry.l1(), omega1, alpha1);
        let ad = turning(pose.u4 * geometry.l4(), omega4, alpha4);

        let f1 = (turning(r1, omega1, alpha1) - g) * link1.mass;
        let f2 = (ab + turning(r2, omega2, alpha2) - g) * link2.mass;
        let f3 = (ad + turning(r3, omega3, alpha3) - g) * link3.mass;
        let f4 = (turning(r4, omega4, alpha4) - g) * link4.mass;
        let fc = (accelerations.c - g) * self.payload() - external_force;
        LinkForces {
            f1,
            f2,
            f3,
            f4,
            fc,
            k1: r1.cross_z(f1) + link1.inertia * alpha1,
            k2: r2.cross_z(f2) + link2.inertia * alpha2 + (pose.u2 * geometry.l2()).cross_z(fc),
            k3: r3.cross_z(f3) + link3.inertia * alpha3,
            k4: r4.cross_z(f4) + link4.inertia * alpha4,
        }
    }
}

/// Forces fj = mj (aj − g) [N] on the links, fc on the payload without the external force, and
/// their moments kj about each link's proximal joint [N·m], fc's being part of k2.
pub(super) struct LinkForces<S> {
    pub(super) f1: Vector2<S>,
    pub(super) f2: Vector2<S>,
    pub(super) f3: Vector2<S>,
    pub(super) f4: Vector2<S>,
    pub(super) fc: Vector2<S>,
    pub(super) k1: S,
    pub(super) k2: S,
    pub(super) k3: S,
    pub(super) k4: S,
}

/// Acceleration of a point at r from a fixed point of a turning body: α r⊥ − ω² r.
#[inline]
fn turning<S: Scalar>(r: Vector2<S>, omega: S, alpha: S) -> Vector2<S> {
    r.perpendicular() * alpha - r * (omega * omega)
}
