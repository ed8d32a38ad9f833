//! Kinetic and potential energy, from the velocities and positions of the bodies.

use super::Arm;
use crate::five_bar::{Pose, Velocities};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

impl<S: Scalar> Arm<S> {
    /// Σj ½ (mj |vj|² + Ij ωj²), with payload and rotors [J].
    pub fn kinetic_energy(&self, pose: &Pose<S>, velocities: &Velocities<S>) -> S {
        let geometry = self.geometry();
        let [omega1, _, _, omega4] = velocities.omega;
        let vb = pose.u1.perpendicular() * (geometry.l1() * omega1);
        let vd = pose.u4.perpendicular() * (geometry.l4() * omega4);
        let roots = [Vector2::zeros(), vb, vd, Vector2::zeros()];
        let units = [pose.u1, pose.u2, pose.u3, pose.u4];
        let [rotor1, rotor4] = self.rotor_inertia();
        let mut twice = self.payload() * velocities.c.length_squared()
            + rotor1 * omega1 * omega1
            + rotor4 * omega4 * omega4;
        for (((link, root), u), omega) in self
            .links()
            .iter()
            .zip(roots)
            .zip(units)
            .zip(velocities.omega)
        {
            let v = root + link.com.to_base_frame(u).perpendicular() * omega;
            twice = twice + link.mass * v.length_squared() + link.inertia * omega * omega;
        }
        S::HALF * twice
    }

    /// −Σj mj g·rj, zero with every mass at A [J].
    pub fn potential_energy(&self, pose: &Pose<S>) -> S {
        let g = self.gravity();
        let roots = [Vector2::zeros(), pose.b, pose.d, self.geometry().e()];
        let units = [pose.u1, pose.u2, pose.u3, pose.u4];
        let mut energy = -self.payload() * g.dot(&pose.c);
        for ((link, root), u) in self.links().iter().zip(roots).zip(units) {
            energy -= link.mass * g.dot(&(root + link.com.to_base_frame(u)));
        }
        energy
    }
}
