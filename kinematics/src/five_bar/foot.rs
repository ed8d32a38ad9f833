//! What the motors of a leg need in a control period, in one pass, for a processor without a floating-point unit.
//!
//! With q2 = BC, q3 = DC and the X of each leg, as in [`Tool::actuated_joints`], ṙC·q2 = X1 ω1 and ṙC·q3 = X4 ω4.
//! A force on C is F = f2 q2 + f3 q3, f2 = F×q3/(q2×q3), f3 = q2×F/(q2×q3). Its power is f2 X1 ω1 + f3 X4 ω4,
//! so that the motors hold it with τ1 = −f2 X1, τ4 = −f3 X4. No direction is normalised.
//!
//! [`Tool::actuated_joints`]: super::Tool::actuated_joints

use super::inverse::{refusal1, refusal4};
use super::motion::per_sine;
use super::{Geometry, PoseError, Singularity, WorkingMode};
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// What holds and moves the foot of a leg; index 0 is joint 1, index 1 joint 4.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, WorkingMode};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// // Thighs of 90 mm, shanks of 160 mm, motors 40 mm apart, knees outwards.
/// let leg = Geometry::new([0.09_f64, 0.16, 0.16, 0.09, 0.04])?;
/// let knees_out = WorkingMode::new(Side::Left, Side::Right);
///
/// // The foot is in the middle below the hips [m] and rises [m/s]; the ground carries 20 N.
/// let (foot, velocity, ground) = (Vector2::new(0.02, -0.18), Vector2::new(0.0, 0.2), Vector2::new(0.0, 20.0));
/// let motors = leg.drive_foot(foot, velocity, ground, knees_out)?;
/// assert!((motors.rate[0] + motors.rate[1]).abs() < 1e-12); // rad/s
/// assert!((motors.torque[0] + motors.torque[1]).abs() < 1e-12); // N·m
/// // The knees bend, and the motors give way to the ground: they take its power.
/// let power = motors.torque[0] * motors.rate[0] + motors.torque[1] * motors.rate[1];
/// assert!((power + 20.0 * 0.2).abs() < 1e-12); // W
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootDrive<S> {
    /// θ1, θ4 [rad], in (−π, π].
    pub angle: [S; 2],
    /// ω1, ω4 [rad/s].
    pub rate: [S; 2],
    /// −Jᵀ F [N·m]: the torques that hold against the force.
    pub torque: [S; 2],
}

impl<S: Scalar> Geometry<S> {
    /// What holds C at `foot` [m] against `force` [N] on it, while it moves with `velocity` [m/s]. It takes about
    /// seven eighths of the work of [`Geometry::inverse`], [`Geometry::inverse_velocities`] and [`Geometry::jacobian`].
    ///
    /// # Errors
    /// As those three.
    #[inline]
    pub fn drive_foot(
        &self,
        foot: Vector2<S>,
        velocity: Vector2<S>,
        force: Vector2<S>,
        knees: WorkingMode,
    ) -> Result<FootDrive<S>, PoseError> {
        let closed1 = self.leg1().solve_precisely(foot, knees.elbow1.opposite());
        let closed1 = closed1.map_err(refusal1)?;
        let closed4 = self
            .leg4()
            .solve_precisely_to(foot, knees.elbow4.opposite());
        let closed4 = closed4.map_err(refusal4)?;
        let q2 = foot - closed1.joint;
        let q3 = foot - self.e() - closed4.joint;

        let [_, per_l2, per_l3, _] = self.per_length();
        let per_lengths = per_l2 * per_l3;
        let sin32 = q2.cross_z(q3) * per_lengths;
        let per_cross = per_sine(sin32, Singularity::Parallel)? * per_lengths;
        // The solutions' crosses are −X.
        Ok(FootDrive {
            angle: [closed1.joint, closed4.joint].map(Vector2::polar_angle),
            rate: [
                -velocity.dot(&q2) / closed1.cross,
                -velocity.dot(&q3) / closed4.cross,
            ],
            torque: [
                force.cross_z(q3) * per_cross * closed1.cross,
                q2.cross_z(force) * per_cross * closed4.cross,
            ],
        })
    }
}
