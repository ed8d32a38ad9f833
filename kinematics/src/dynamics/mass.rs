//! The equations of motion in the driven angles: M(q) q̈ + h(q, q̇) = τ.
//!
//! By Kane, with the partial velocities vjr of the centres of mass and ωjr of the links:
//! Mrs = Σj [mj vjr·vjs + Ij ωjr ωjs] + rotor inertia; h is the torque at q̈ = 0.

use super::Arm;
use crate::five_bar::{Pose, PoseError, Velocities};
use crate::{Scalar, Vec2};

/// M(q), symmetric and positive definite [kg·m²].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassMatrix<S> {
    /// ∂τ1/∂α1.
    pub m11: S,
    /// ∂τ1/∂α4 = ∂τ4/∂α1.
    pub m14: S,
    /// ∂τ4/∂α4.
    pub m44: S,
}

impl<S: Scalar> MassMatrix<S> {
    /// M q̈ [N·m].
    #[inline]
    pub fn times(&self, [alpha1, alpha4]: [S; 2]) -> [S; 2] {
        [
            self.m11 * alpha1 + self.m14 * alpha4,
            self.m14 * alpha1 + self.m44 * alpha4,
        ]
    }

    /// M⁻¹ τ [rad/s²].
    #[inline]
    pub fn solve(&self, [torque1, torque4]: [S; 2]) -> [S; 2] {
        let per_determinant = S::ONE / (self.m11 * self.m44 - self.m14 * self.m14);
        [
            (self.m44 * torque1 - self.m14 * torque4) * per_determinant,
            (self.m11 * torque4 - self.m14 * torque1) * per_determinant,
        ]
    }
}

/// Velocity per unit of ω1 and per unit of ω4.
type Pair<T> = [T; 2];

impl<S: Scalar> Arm<S> {
    /// M(q) at a pose.
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn mass_matrix(&self, pose: &Pose<S>) -> Result<MassMatrix<S>, PoseError> {
        let [rotor1, rotor4] = self.rotor_inertia();
        let mut matrix = MassMatrix {
            m11: rotor1,
            m14: S::ZERO,
            m44: rotor4,
        };
        let mut add = |mass: S, [v1, v4]: Pair<Vec2<S>>, inertia: S, [w1, w4]: Pair<S>| {
            matrix.m11 = matrix.m11 + mass * v1.norm_squared() + inertia * w1 * w1;
            matrix.m14 = matrix.m14 + mass * v1.dot(v4) + inertia * w1 * w4;
            matrix.m44 = matrix.m44 + mass * v4.norm_squared() + inertia * w4 * w4;
        };
        let (spins, points, c) = self.partial_motion(pose)?;
        for ((link, spin), point) in self.links().iter().zip(spins).zip(points) {
            add(link.mass, point, link.inertia, spin);
        }
        add(self.payload(), c, S::ZERO, [S::ZERO; 2]);
        Ok(matrix)
    }

    /// h(q, q̇) [N·m]: the torques that velocity products, gravity and the external force
    /// [N] on C ask for.
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn bias(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        external_force: Vec2<S>,
    ) -> Result<[S; 2], PoseError> {
        let geometry = self.geometry();
        let coasting = geometry.forward_accelerations(pose, velocities, S::ZERO, S::ZERO)?;
        self.inverse_dynamics(pose, velocities, &coasting, external_force)
    }

    /// α1, α4 [rad/s²] under the driving torques [N·m] and an external force [N] on C:
    /// q̈ = M⁻¹ (τ − h). Without friction.
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn forward_dynamics(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        torque: [S; 2],
        external_force: Vec2<S>,
    ) -> Result<[S; 2], PoseError> {
        let bias = self.bias(pose, velocities, external_force)?;
        let net = [torque[0] - bias[0], torque[1] - bias[1]];
        Ok(self.mass_matrix(pose)?.solve(net))
    }

    /// The torques [N·m] that hold the arm against gravity: −Σj mj g·vjr.
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn gravity_torque(&self, pose: &Pose<S>) -> Result<[S; 2], PoseError> {
        let g = self.gravity();
        let (_, points, [c1, c4]) = self.partial_motion(pose)?;
        let mut torque = [-self.payload() * g.dot(c1), -self.payload() * g.dot(c4)];
        for (link, [v1, v4]) in self.links().iter().zip(points) {
            torque[0] = torque[0] - link.mass * g.dot(v1);
            torque[1] = torque[1] - link.mass * g.dot(v4);
        }
        Ok(torque)
    }

    /// ωjr of links 1…4, vjr of their centres of mass, and vCr.
    #[allow(clippy::type_complexity)]
    fn partial_motion(
        &self,
        pose: &Pose<S>,
    ) -> Result<([Pair<S>; 4], [Pair<Vec2<S>>; 4], Pair<Vec2<S>>), PoseError> {
        let geometry = self.geometry();
        let partial = self.partial_velocities(pose)?;
        let vc = geometry.jacobian(pose)?;
        let [link1, link2, link3, link4] = self.links();
        let still = Vec2::zero();
        let b = pose.u1.perp() * geometry.l1();
        let d = pose.u4.perp() * geometry.l4();
        let n1 = link1.com.rotated_to(pose.u1).perp();
        let n2 = link2.com.rotated_to(pose.u2).perp();
        let n3 = link3.com.rotated_to(pose.u3).perp();
        let n4 = link4.com.rotated_to(pose.u4).perp();
        Ok((
            [
                [S::ONE, S::ZERO],
                [partial.omega21, partial.omega24],
                [partial.omega31, partial.omega34],
                [S::ZERO, S::ONE],
            ],
            [
                [n1, still],
                [b + n2 * partial.omega21, n2 * partial.omega24],
                [n3 * partial.omega31, d + n3 * partial.omega34],
                [still, n4],
            ],
            [vc.c1, vc.c4],
        ))
    }
}
