//! Velocities and accelerations, both ways (Yu 2007, section 1).
//!
//! With sin(θ3−θ2) = u2×u3, and v, a the velocity and acceleration of D relative to B:
//!
//! ω2 = v·u3 / (l2 sin(θ3−θ2)), ω3 = v·u2 / (l3 sin(θ3−θ2)),
//! α2 = [a·u3 + l2 ω2² cos(θ3−θ2) − l3 ω3²] / (l2 sin(θ3−θ2)),
//! α3 = [a·u2 − l3 ω3² cos(θ3−θ2) + l2 ω2²] / (l3 sin(θ3−θ2)).
//!
//! **Erratum**: the printed inverse ω2 has l1 for l2 and the wrong sign; here
//! ω1 = ṙC·u2 / (l1 sin(θ2−θ1)), ω2 = −ṙC·u1 / (l2 sin(θ2−θ1)).
//!
//! Each function divides once per sine, in [`per_sine`]; the geometry holds the reciprocals of
//! the lengths.

use super::dyad::least_sine_squared;
use super::{Geometry, Pose, PoseError, Singularity};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// Angular velocities of the links and the velocity of C.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side};
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let pose = geometry.forward(2.0, 1.1, Side::Left)?; // rad
/// let velocities = geometry.forward_velocities(&pose, 3.0, -1.0)?; // rad/s
///
/// // The difference quotient over a microsecond gives the same velocity of C [m/s].
/// let dt = 1e-6;
/// let later = geometry.forward(2.0 + 3.0 * dt, 1.1 - dt, Side::Left)?;
/// assert!(velocities.c.norm() > 0.1);
/// assert!(((later.c - pose.c) / dt - velocities.c).norm() < 1e-4);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocities<S> {
    /// ω1, ω2, ω3, ω4 [rad/s].
    pub omega: [S; 4],
    /// ṙC [m/s].
    pub c: Vector2<S>,
}

/// Angular accelerations of the links and the acceleration of C.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let pose = geometry.inverse(Vector2::new(0.04, 0.20), WorkingMode::new(Side::Right, Side::Left))?;
/// let velocities = geometry.inverse_velocities(&pose, Vector2::new(0.5, 0.0))?; // m/s
/// let wanted = Vector2::new(0.0, 4.0); // m/s²
/// let inverse = geometry.inverse_accelerations(&pose, &velocities, wanted)?;
///
/// // The driven accelerations [rad/s²] give C the acceleration that they were computed from.
/// let [alpha1, _, _, alpha4] = inverse.alpha;
/// let forward = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
/// assert!((forward.c - wanted).norm() < 1e-12);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerations<S> {
    /// α1, α2, α3, α4 [rad/s²].
    pub alpha: [S; 4],
    /// r̈C [m/s²].
    pub c: Vector2<S>,
}

/// 1/sin θ, or the singularity if sin θ is 0 to rounding: see [`least_sine_squared`].
#[inline(always)]
pub(crate) fn per_sine<S: Scalar>(sine: S, singularity: Singularity) -> Result<S, PoseError> {
    if sine * sine > least_sine_squared() {
        Ok(S::ONE / sine)
    } else {
        Err(PoseError::Singular(singularity))
    }
}

impl<S: Scalar> Geometry<S> {
    /// All velocities from the driven ones, ω1 and ω4 [rad/s].
    ///
    /// # Errors
    /// `Singular` at type 2.
    #[inline]
    pub fn forward_velocities(
        &self,
        pose: &Pose<S>,
        omega1: S,
        omega4: S,
    ) -> Result<Velocities<S>, PoseError> {
        let per_sin32 = per_sine(pose.sin32(), Singularity::Parallel)?;
        let [_, per_l2, per_l3, _] = self.per_length();
        let vb = pose.u1.perpendicular() * (self.l1() * omega1);
        let vd = pose.u4.perpendicular() * (self.l4() * omega4);
        let v = vd - vb;
        let omega2 = v.dot(&pose.u3) * (per_l2 * per_sin32);
        let omega3 = v.dot(&pose.u2) * (per_l3 * per_sin32);
        Ok(Velocities {
            omega: [omega1, omega2, omega3, omega4],
            c: vb + pose.u2.perpendicular() * (self.l2() * omega2),
        })
    }

    /// All accelerations from the driven ones, α1 and α4 [rad/s²].
    ///
    /// # Errors
    /// `Singular` at type 2.
    #[inline]
    pub fn forward_accelerations(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        alpha1: S,
        alpha4: S,
    ) -> Result<Accelerations<S>, PoseError> {
        let per_sin32 = per_sine(pose.sin32(), Singularity::Parallel)?;
        let [_, per_l2, per_l3, _] = self.per_length();
        let cos32 = pose.u2.dot(&pose.u3);
        let [omega1, omega2, omega3, omega4] = velocities.omega;
        let (l2, l3) = (self.l2(), self.l3());
        let ab = link_end(pose.u1, self.l1(), omega1, alpha1);
        let ad = link_end(pose.u4, self.l4(), omega4, alpha4);
        let a = ad - ab;
        let centripetal2 = l2 * omega2 * omega2;
        let centripetal3 = l3 * omega3 * omega3;
        let alpha2 = (a.dot(&pose.u3) + centripetal2 * cos32 - centripetal3) * (per_l2 * per_sin32);
        let alpha3 = (a.dot(&pose.u2) - centripetal3 * cos32 + centripetal2) * (per_l3 * per_sin32);
        Ok(Accelerations {
            alpha: [alpha1, alpha2, alpha3, alpha4],
            c: ab + link_end(pose.u2, l2, omega2, alpha2),
        })
    }

    /// All velocities from C's, ṙC [m/s].
    ///
    /// # Errors
    /// `Singular` at type 1, naming the leg.
    #[inline]
    pub fn inverse_velocities(
        &self,
        pose: &Pose<S>,
        c_velocity: Vector2<S>,
    ) -> Result<Velocities<S>, PoseError> {
        let per_sin21 = per_sine(pose.sin21(), Singularity::Leg1)?;
        let [per_l1, per_l2, ..] = self.per_length();
        let [omega3, omega4] = self.leg4_velocities(pose, c_velocity)?;
        Ok(Velocities {
            omega: [
                c_velocity.dot(&pose.u2) * (per_l1 * per_sin21),
                -c_velocity.dot(&pose.u1) * (per_l2 * per_sin21),
                omega3,
                omega4,
            ],
            c: c_velocity,
        })
    }

    /// All accelerations from C's, r̈C [m/s²].
    ///
    /// From r̈C·u2 = l1 α1 sin(θ2−θ1) − l1 ω1² cos(θ2−θ1) − l2 ω2², and alike for the rest.
    ///
    /// # Errors
    /// `Singular` at type 1, naming the leg.
    #[inline]
    pub fn inverse_accelerations(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        c_acceleration: Vector2<S>,
    ) -> Result<Accelerations<S>, PoseError> {
        let per_sin21 = per_sine(pose.sin21(), Singularity::Leg1)?;
        let [per_l1, per_l2, ..] = self.per_length();
        let [omega1, omega2, ..] = velocities.omega;
        // The part of the acceleration that angular accelerations give.
        let a = c_acceleration
            + pose.u1 * (self.l1() * omega1 * omega1)
            + pose.u2 * (self.l2() * omega2 * omega2);
        let [alpha3, alpha4] = self.leg4_accelerations(pose, velocities, c_acceleration)?;
        Ok(Accelerations {
            alpha: [
                a.dot(&pose.u2) * (per_l1 * per_sin21),
                -a.dot(&pose.u1) * (per_l2 * per_sin21),
                alpha3,
                alpha4,
            ],
            c: c_acceleration,
        })
    }

    /// ω3, ω4 from ṙC.
    #[inline]
    pub(super) fn leg4_velocities(
        &self,
        pose: &Pose<S>,
        c_velocity: Vector2<S>,
    ) -> Result<[S; 2], PoseError> {
        let per_sin34 = per_sine(pose.sin34(), Singularity::Leg4)?;
        let [_, _, per_l3, per_l4] = self.per_length();
        Ok([
            -c_velocity.dot(&pose.u4) * (per_l3 * per_sin34),
            c_velocity.dot(&pose.u3) * (per_l4 * per_sin34),
        ])
    }

    /// α3, α4 from r̈C.
    #[inline]
    pub(super) fn leg4_accelerations(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        c_acceleration: Vector2<S>,
    ) -> Result<[S; 2], PoseError> {
        let per_sin34 = per_sine(pose.sin34(), Singularity::Leg4)?;
        let [_, _, per_l3, per_l4] = self.per_length();
        let [_, _, omega3, omega4] = velocities.omega;
        let a = c_acceleration
            + pose.u4 * (self.l4() * omega4 * omega4)
            + pose.u3 * (self.l3() * omega3 * omega3);
        Ok([
            -a.dot(&pose.u4) * (per_l3 * per_sin34),
            a.dot(&pose.u3) * (per_l4 * per_sin34),
        ])
    }
}

/// Acceleration of a link's far end relative to its near one: l (α n − ω² u).
#[inline]
fn link_end<S: Scalar>(u: Vector2<S>, length: S, omega: S, alpha: S) -> Vector2<S> {
    u.perpendicular() * (length * alpha) - u * (length * omega * omega)
}
