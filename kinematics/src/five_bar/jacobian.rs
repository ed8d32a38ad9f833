//! The Jacobians between the driven rates and C's velocity, and the measures of a pose that
//! follow from them.
//!
//! Projecting ṙC on links 2 and 3 removes their unknown rates:
//! ṙC·u2 = l1 sin(θ2−θ1) ω1, ṙC·u3 = l4 sin(θ3−θ4) ω4. Solved for ṙC = vC1 ω1 + vC4 ω4:
//!
//! vC1 = −l1 sin(θ2−θ1)/sin(θ3−θ2) n3, vC4 = l4 sin(θ3−θ4)/sin(θ3−θ2) n2,
//!
//! and for the rates, ω1 = u2·ṙC/(l1 sin(θ2−θ1)), ω4 = u3·ṙC/(l4 sin(θ3−θ4)).

use super::motion::per_sine;
use super::{Geometry, Pose, PoseError, Singularity, Tool};
use crate::{PlanarVector, Scalar};
use nalgebra::{Matrix2, Vector2};

/// ṙC = J q̇ with q̇ = (ω1, ω4): the partial velocities of C, which are J's columns; from
/// [`Tool::jacobian`], those of the tool T.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let pose = geometry.inverse(Vector2::new(0.06, 0.18), WorkingMode::new(Side::Right, Side::Left))?;
/// let jacobian = geometry.jacobian(&pose)?;
///
/// // The power of a force on C is the power of the torques it causes: F·ṙC = τ·q̇.
/// let (force, rates) = (Vector2::new(2.0, -5.0), [1.5, -0.5]); // N, rad/s
/// let [torque1, torque4] = jacobian.torques(force); // N·m
/// let power = force.dot(&jacobian.velocity(rates));
/// assert!((power - (torque1 * rates[0] + torque4 * rates[1])).abs() < 1e-15);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jacobian<S> {
    /// vC1 = ∂ṙC/∂ω1 [m].
    pub c1: Vector2<S>,
    /// vC4 = ∂ṙC/∂ω4 [m].
    pub c4: Vector2<S>,
}

/// q̇ = J⁻¹ ṙC: the rows of J⁻¹, finite where J itself is not (type 2).
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::{Matrix2, Vector2};
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let pose = geometry.inverse(Vector2::new(0.06, 0.18), WorkingMode::new(Side::Right, Side::Left))?;
/// let inverse = geometry.inverse_jacobian(&pose)?;
/// let product = inverse.matrix() * geometry.jacobian(&pose)?.matrix();
/// assert!((product - Matrix2::identity()).norm() < 1e-14);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InverseJacobian<S> {
    /// ∂ω1/∂ṙC [1/m].
    pub joint1: Vector2<S>,
    /// ∂ω4/∂ṙC [1/m].
    pub joint4: Vector2<S>,
}

impl<S: Scalar> Geometry<S> {
    /// J at a pose.
    ///
    /// # Errors
    /// `Singular` at type 2.
    #[inline]
    pub fn jacobian(&self, pose: &Pose<S>) -> Result<Jacobian<S>, PoseError> {
        let per_sin32 = per_sine(pose.sin32(), Singularity::Parallel)?;
        Ok(Jacobian {
            c1: pose.u3.perpendicular() * (-self.l1() * pose.sin21() * per_sin32),
            c4: pose.u2.perpendicular() * (self.l4() * pose.sin34() * per_sin32),
        })
    }

    /// J⁻¹ at a pose.
    ///
    /// # Errors
    /// `Singular` at type 1, naming the leg.
    #[inline]
    pub fn inverse_jacobian(&self, pose: &Pose<S>) -> Result<InverseJacobian<S>, PoseError> {
        let [per_l1, _, _, per_l4] = self.per_length();
        let per_sin21 = per_sine(pose.sin21(), Singularity::Leg1)?;
        let per_sin34 = per_sine(pose.sin34(), Singularity::Leg4)?;
        Ok(InverseJacobian {
            joint1: pose.u2 * (per_l1 * per_sin21),
            joint4: pose.u3 * (per_l4 * per_sin34),
        })
    }
}

impl<S: Scalar> Tool<S> {
    /// J of the tool T: ṙT = ṙC + ω2 t⊥ for a unit of each driven rate, t = rT − rC.
    ///
    /// # Errors
    /// `Singular` at type 2.
    #[inline]
    pub fn jacobian(&self, pose: &Pose<S>) -> Result<Jacobian<S>, PoseError> {
        let of = |omega1, omega4| {
            let velocities = self.geometry().forward_velocities(pose, omega1, omega4)?;
            Ok::<_, PoseError>(self.velocity(pose, &velocities))
        };
        Ok(Jacobian {
            c1: of(S::ONE, S::ZERO)?,
            c4: of(S::ZERO, S::ONE)?,
        })
    }
}

impl<S: Scalar> Jacobian<S> {
    /// J [m], its columns vC1 and vC4.
    #[inline]
    pub fn matrix(&self) -> Matrix2<S> {
        Matrix2::new(self.c1.x, self.c4.x, self.c1.y, self.c4.y)
    }

    /// ṙC [m/s] of the rates (ω1, ω4) [rad/s].
    #[inline]
    pub fn velocity(&self, [omega1, omega4]: [S; 2]) -> Vector2<S> {
        self.c1 * omega1 + self.c4 * omega4
    }

    /// Jᵀ F: the torques [N·m] about joints 1 and 4 of a force [N] that acts on C. The motors
    /// hold against it with −Jᵀ F.
    #[inline]
    pub fn torques(&self, force: Vector2<S>) -> [S; 2] {
        [force.dot(&self.c1), force.dot(&self.c4)]
    }

    /// σmax ≥ σmin ≥ 0 [m/rad]: C's greatest and least speed per unit of joint rate.
    ///
    /// σmax ± σmin = √(|vC1|² + |vC4|² ± 2 |det J|).
    #[inline]
    pub fn singular_values(&self) -> [S; 2] {
        let squares = self.c1.length_squared() + self.c4.length_squared();
        let det = self.manipulability();
        let sum = (squares + S::TWO * det).sqrt();
        let rest = squares - S::TWO * det;
        let difference = if rest > S::ZERO { rest.sqrt() } else { S::ZERO };
        let greatest = S::HALF * (sum + difference);
        let least = if greatest > S::ZERO {
            det / greatest
        } else {
            S::ZERO
        };
        [greatest, least]
    }

    /// Yoshikawa's manipulability |det J| = σmax σmin [m²]: zero at type 1.
    #[inline]
    pub fn manipulability(&self) -> S {
        self.c1.cross_z(self.c4).abs()
    }

    /// σmin/σmax in 0…1, the inverse of the condition number: 1 where C moves alike in
    /// every direction, 0 where a direction is lost.
    #[inline]
    pub fn inverse_condition(&self) -> S {
        let [greatest, least] = self.singular_values();
        if greatest > S::ZERO {
            least / greatest
        } else {
            S::ZERO
        }
    }
}

impl<S: Scalar> InverseJacobian<S> {
    /// J⁻¹ [1/m].
    #[inline]
    pub fn matrix(&self) -> Matrix2<S> {
        Matrix2::new(self.joint1.x, self.joint1.y, self.joint4.x, self.joint4.y)
    }

    /// (ω1, ω4) [rad/s] of ṙC [m/s].
    #[inline]
    pub fn joint_rates(&self, c_velocity: Vector2<S>) -> [S; 2] {
        [self.joint1.dot(&c_velocity), self.joint4.dot(&c_velocity)]
    }
}
