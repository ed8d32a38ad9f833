//! The parts of a driving torque, at one instant and along a motion. They show how far the
//! conclusion of Yu 2007, "inertia forces dominate", holds.

use super::Arm;
use crate::Scalar;
use crate::five_bar::{Accelerations, Pose, PoseError, Velocities};
use nalgebra::Vector2;

/// The parts of the driving torques, each [joint 1, joint 4]; they add up to the torque.
///
/// ```
/// use fivebar_kinematics::dynamics::{Arm, Link};
/// use fivebar_kinematics::five_bar::{Geometry, Side};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let rods = [0.10, 0.16, 0.16, 0.10].map(|length| Link::uniform_rod(0.06, length)); // kg, m
/// let arm = Arm::new(geometry, rods, 0.03, Vector2::new(0.0, -9.81), [2e-5; 2])?;
/// let pose = geometry.forward(2.0, 1.1, Side::Left)?;
/// let velocities = geometry.forward_velocities(&pose, 3.0, -1.0)?; // rad/s
/// let accelerations = geometry.forward_accelerations(&pose, &velocities, 40.0, 20.0)?; // rad/s²
///
/// let (force, friction) = (Vector2::new(1.0, 0.0), [0.002, 0.002]); // N, N·m
/// let parts = arm.torque_components(&pose, &velocities, &accelerations, force, friction)?;
/// let torque = arm.inverse_dynamics(&pose, &velocities, &accelerations, force)?;
/// assert!((parts.total()[0] - torque[0] - friction[0]).abs() < 1e-14);
/// assert!(parts.inertia[0].abs() > parts.velocity[0].abs());
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueComponents<S> {
    /// M q̈: the demanded accelerations, with the rotors.
    pub inertia: [S; 2],
    /// Velocity products (centripetal and Coriolis).
    pub velocity: [S; 2],
    /// Holding the arm against gravity.
    pub gravity: [S; 2],
    /// Holding the arm against the external force: −Jᵀ F.
    pub external: [S; 2],
    /// Friction of the driven joints.
    pub friction: [S; 2],
}

impl<S: Scalar> TorqueComponents<S> {
    /// Names of the parts, in the order of [`TorqueComponents::parts`].
    pub const NAMES: [&'static str; 5] = ["inertia", "velocity", "gravity", "external", "friction"];

    /// The parts in the order of [`TorqueComponents::NAMES`].
    pub fn parts(&self) -> [[S; 2]; 5] {
        [
            self.inertia,
            self.velocity,
            self.gravity,
            self.external,
            self.friction,
        ]
    }

    /// The whole torque.
    pub fn total(&self) -> [S; 2] {
        self.parts().iter().fold([S::ZERO; 2], |sum, part| {
            [sum[0] + part[0], sum[1] + part[1]]
        })
    }
}

impl<S: Scalar> Arm<S> {
    /// The parts of the torques of a motion, each computed independently; `friction`
    /// is the torque that overcomes it in each joint [N·m].
    ///
    /// # Errors
    /// `Singular` at type 2.
    pub fn torque_components(
        &self,
        pose: &Pose<S>,
        velocities: &Velocities<S>,
        accelerations: &Accelerations<S>,
        external_force: Vector2<S>,
        friction: [S; 2],
    ) -> Result<TorqueComponents<S>, PoseError> {
        let geometry = self.geometry();
        let [alpha1, _, _, alpha4] = accelerations.alpha;
        let coasting = geometry.forward_accelerations(pose, velocities, S::ZERO, S::ZERO)?;
        let weightless = self.weightless();
        Ok(TorqueComponents {
            inertia: (self.mass_matrix(pose)? * Vector2::new(alpha1, alpha4)).into(),
            velocity: weightless.inverse_dynamics(pose, velocities, &coasting, Vector2::zeros())?,
            gravity: self.gravity_torque(pose)?,
            external: geometry.jacobian(pose)?.torques(-external_force),
            friction,
        })
    }
}

/// Torque parts summed along a motion.
///
/// ```
/// use fivebar_kinematics::dynamics::{ShareTotals, TorqueComponents};
///
/// let none = [0.0; 2];
/// let mut totals = ShareTotals::default();
/// for inertia in [0.3, -0.3] { // N·m, each for 1 ms
///     let parts = TorqueComponents {
///         inertia: [inertia; 2],
///         gravity: [0.1; 2],
///         velocity: none,
///         external: none,
///         friction: none,
///     };
///     totals.add(&parts, 1e-3);
/// }
/// let [inertia, _, gravity, ..] = totals.fractions();
/// assert!((inertia[0] - 0.75_f64).abs() < 1e-15 && (gravity[0] - 0.25).abs() < 1e-15);
/// assert_eq!(totals.peaks()[0], [0.3, 0.3]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShareTotals<S> {
    /// ∫|τ| dt of each part [N·m·s], in the order of [`TorqueComponents::NAMES`].
    impulse: [[S; 2]; 5],
    /// The largest |τ| of each part so far [N·m].
    peak: [[S; 2]; 5],
}

impl<S: Scalar> Default for ShareTotals<S> {
    fn default() -> Self {
        Self {
            impulse: [[S::ZERO; 2]; 5],
            peak: [[S::ZERO; 2]; 5],
        }
    }
}

impl<S: Scalar> ShareTotals<S> {
    /// Adds an instant that lasts `dt` [s].
    pub fn add(&mut self, shares: &TorqueComponents<S>, dt: S) {
        let sums = self.impulse.iter_mut().zip(&mut self.peak);
        for (part, (impulse, peak)) in shares.parts().iter().zip(sums) {
            for ((torque, impulse), peak) in part.iter().zip(impulse).zip(peak) {
                *impulse += torque.abs() * dt;
                if torque.abs() > *peak {
                    *peak = torque.abs();
                }
            }
        }
    }

    /// The share of each part in the sum of ∫|τ| dt over all parts, for each joint. The shares
    /// add up to 1, or are all 0 without any torque.
    pub fn fractions(&self) -> [[S; 2]; 5] {
        let sum = self.impulse.iter().fold([S::ZERO; 2], |sum, part| {
            [sum[0] + part[0], sum[1] + part[1]]
        });
        let portion = |part: S, sum: S| if sum > S::ZERO { part / sum } else { S::ZERO };
        self.impulse
            .map(|[part1, part4]| [portion(part1, sum[0]), portion(part4, sum[1])])
    }

    /// The largest |τ| of each part [N·m].
    pub fn peaks(&self) -> [[S; 2]; 5] {
        self.peak
    }
}
