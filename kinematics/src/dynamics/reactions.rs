//! Forces in the five joints, and the torques that follow from them (Newton–Euler).
//!
//! Link 3 balanced about D and link 2 about B leave the force at C:
//! l3 u3×c = k3, l2 u2×c = −k2, so that
//! c = −k3/(l3 sin(θ3−θ2)) u2 − k2/(l2 sin(θ3−θ2)) u3.
//! The others follow link by link: b = f2 + fc + c, d = f3 − c, a = f1 + b, e = f4 + d.

use super::Arm;
use super::kane::LinkForces;
use crate::five_bar::{Accelerations, Pose, PoseError, Singularity, Velocities, per_sine};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The forces that act in the joints [N].
///
/// ```
/// use fivebar_kinematics::dynamics::{Arm, Link};
/// use fivebar_kinematics::five_bar::{Geometry, Side};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(0.06, length)); // kg, m
/// let arm = Arm::new(geometry, rods, 0.03, Vector2::new(0.0, -9.81), [0.0; 2])?;
/// let pose = geometry.forward(2.0, 1.1, Side::Left)?;
/// let velocities = geometry.forward_velocities(&pose, 0.0, 0.0)?;
/// let accelerations = geometry.forward_accelerations(&pose, &velocities, 0.0, 0.0)?;
///
/// // At rest, the ground carries the weight of four rods and the payload [N].
/// let forces = arm.reactions(&pose, &velocities, &accelerations, Vector2::zeros())?;
/// let weight = (4.0 * 0.06 + 0.03) * 9.81;
/// assert!((forces.a + forces.e - Vector2::new(0.0, weight)).norm() < 1e-13);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reactions<S> {
    /// Of the ground on link 1, at A.
    pub a: Vector2<S>,
    /// Of link 1 on link 2, at B.
    pub b: Vector2<S>,
    /// Of link 2, which carries the payload and the external force, on link 3, at C.
    pub c: Vector2<S>,
    /// Of link 4 on link 3, at D.
    pub d: Vector2<S>,
    /// Of the ground on link 4, at E.
    pub e: Vector2<S>,
    /// The driving torques that balance them [N·m], on link 1 at A and link 4 at E. They equal
    /// those of [`Arm::inverse_dynamics`] and are computed independently.
    pub torque: [S; 2],
}

impl<S: Scalar> Arm<S> {
    /// The joint forces of a motion, with `external_force` [N] on C.
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn reactions(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        accelerations: &Accelerations<S>,
        external_force: Vector2<S>,
    ) -> Result<Reactions<S>, PoseError> {
        let geometry = self.geometry();
        let per_sin32 = per_sine(pose.sin32(), Singularity::Parallel)?;
        let [_, per_l2, per_l3, _] = geometry.per_length();
        let LinkForces {
            f1,
            f2,
            f3,
            f4,
            fc,
            k1,
            k2,
            k3,
            k4,
        } = self.link_forces(pose, velocities, accelerations, external_force);
        let c = -pose.u2 * (k3 * per_l3 * per_sin32) - pose.u3 * (k2 * per_l2 * per_sin32);
        let b = f2 + fc + c;
        let d = f3 - c;
        let [rotor1, rotor4] = self.rotor_inertia();
        let [alpha1, _, _, alpha4] = accelerations.alpha;
        Ok(Reactions {
            a: f1 + b,
            b,
            c,
            d,
            e: f4 + d,
            torque: [
                k1 + pose.b.cross_z(b) + rotor1 * alpha1,
                k4 + (pose.d - geometry.e()).cross_z(d) + rotor4 * alpha4,
            ],
        })
    }
}
