//! The equations of motion in the driven angles: M(q) q̈ + h(q, q̇) = τ.
//!
//! By Kane, with the partial velocities vjr of the centres of mass and ωjr of the links:
//! Mrs = Σj [mj vjr·vjs + Ij ωjr ωjs] + rotor inertia; h is the torque at q̈ = 0.

use super::Arm;
use crate::five_bar::{Pose, PoseError, Singularity, Velocities};
use crate::{PlanarVector, Scalar};
use nalgebra::{Matrix2, Vector2};

/// Velocity per unit of ω1 and per unit of ω4.
type Pair<T> = [T; 2];

impl<S: Scalar> Arm<S> {
    /// M(q) at a pose [kg·m²], symmetric and positive definite: row and column 1 are joint
    /// 1's, row and column 2 joint 4's.
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn mass_matrix(&self, pose: &Pose<S>) -> Result<Matrix2<S>, PoseError> {
        let [mut m11, mut m44] = self.rotor_inertia();
        let mut m14 = S::ZERO;
        let mut add = |mass: S, [v1, v4]: Pair<Vector2<S>>, inertia: S, [w1, w4]: Pair<S>| {
            m11 = m11 + mass * v1.length_squared() + inertia * w1 * w1;
            m14 = m14 + mass * v1.dot(&v4) + inertia * w1 * w4;
            m44 = m44 + mass * v4.length_squared() + inertia * w4 * w4;
        };
        let (spins, points, c) = self.partial_motion(pose)?;
        for ((link, spin), point) in self.links().iter().zip(spins).zip(points) {
            add(link.mass, point, link.inertia, spin);
        }
        add(self.payload(), c, S::ZERO, [S::ZERO; 2]);
        Ok(Matrix2::new(m11, m14, m14, m44))
    }

    /// h(q, q̇) [N·m]: the torques for velocity products, gravity and the external force [N]
    /// on C, at zero acceleration.
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn nonlinear_effects(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        external_force: Vector2<S>,
    ) -> Result<[S; 2], PoseError> {
        let geometry = self.geometry();
        let coasting = geometry.forward_accelerations(pose, velocities, S::ZERO, S::ZERO)?;
        self.inverse_dynamics(pose, velocities, &coasting, external_force)
    }

    /// α1, α4 [rad/s²] under the driving torques [N·m] and an external force [N] on C:
    /// q̈ = M⁻¹ (τ − h). Without friction.
    ///
    /// Near type 2, with s = sin(θ3−θ2), M and h grow without bound and cancel. A pose is known to the rounding ε of
    /// its sines, and with it s to ε/|s| of itself, so the answer may be off by
    ///
    /// ε/|s| ‖M⁻¹‖ (|τ| + |h| + ‖M‖ |q̈|).
    ///
    /// # Errors
    /// `Singular` at type 2, and so near to it that this exceeds both 1 % of |q̈| and 0.01 rad/s².
    pub fn forward_dynamics(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        torque: [S; 2],
        external_force: Vector2<S>,
    ) -> Result<[S; 2], PoseError> {
        let nonlinear_effects = self.nonlinear_effects(pose, velocities, external_force)?;
        let net = [
            torque[0] - nonlinear_effects[0],
            torque[1] - nonlinear_effects[1],
        ];
        let mass = self.mass_matrix(pose)?;
        let alpha = solve(&mass, net);

        let norm = |[a, b]: [S; 2]| a.abs() + b.abs();
        let trace = mass.m11 + mass.m22;
        let per_inertia = trace / (mass.m11 * mass.m22 - mass.m12 * mass.m12);
        let cancelling = norm(torque) + norm(nonlinear_effects) + trace * norm(alpha);
        let error = S::EPSILON / pose.sin32().abs() * per_inertia * cancelling;
        let hundredth = S::from_f64(0.01);
        // Negated: with a determinant of 0 the error is no number.
        if !(error <= hundredth * norm(alpha) || error <= hundredth) {
            return Err(PoseError::Singular(Singularity::Parallel));
        }
        Ok(alpha)
    }

    /// The torques [N·m] that hold the arm against gravity: −Σj mj g·vjr.
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn gravity_torque(&self, pose: &Pose<S>) -> Result<[S; 2], PoseError> {
        let g = self.gravity();
        let (_, points, [c1, c4]) = self.partial_motion(pose)?;
        let mut torque = [-self.payload() * g.dot(&c1), -self.payload() * g.dot(&c4)];
        for (link, [v1, v4]) in self.links().iter().zip(points) {
            torque[0] -= link.mass * g.dot(&v1);
            torque[1] -= link.mass * g.dot(&v4);
        }
        Ok(torque)
    }

    /// ωjr of links 1…4, vjr of their centres of mass, and vCr.
    #[allow(clippy::type_complexity)]
    fn partial_motion(
        &self,
        pose: &Pose<S>,
    ) -> Result<([Pair<S>; 4], [Pair<Vector2<S>>; 4], Pair<Vector2<S>>), PoseError> {
        let geometry = self.geometry();
        let partial = self.partial_velocities(pose)?;
        let vc = geometry.jacobian(pose)?;
        let [link1, link2, link3, link4] = self.links();
        let still = Vector2::zeros();
        let b = pose.u1.perpendicular() * geometry.l1();
        let d = pose.u4.perpendicular() * geometry.l4();
        let n1 = link1.com.to_base_frame(pose.u1).perpendicular();
        let n2 = link2.com.to_base_frame(pose.u2).perpendicular();
        let n3 = link3.com.to_base_frame(pose.u3).perpendicular();
        let n4 = link4.com.to_base_frame(pose.u4).perpendicular();
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

/// M⁻¹ τ of a symmetric M.
fn solve<S: Scalar>(mass: &Matrix2<S>, [torque1, torque4]: [S; 2]) -> [S; 2] {
    let (m11, m14, m44) = (mass.m11, mass.m12, mass.m22);
    let per_determinant = S::ONE / (m11 * m44 - m14 * m14);
    [
        (m44 * torque1 - m14 * torque4) * per_determinant,
        (m11 * torque4 - m14 * torque1) * per_determinant,
    ]
}
