//! What a driving torque is made of, at a moment and along a motion: the question behind
//! Yu 2007's "inertia forces dominate".

use super::Arm;
use crate::Scalar;
use crate::five_bar::{Accelerations, Pose, PoseError, Velocities};
use nalgebra::Vector2;

/// The parts of the driving torques, each [joint 1, joint 4]; they add up to the torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueComponents<S> {
    /// M q̈: the accelerations asked for, rotors included.
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
    /// The parts of the torques of a motion, each by an expression of its own; `friction`
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
    /// Adds a moment that lasts `dt` [s].
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

    /// Each part's portion of ∫|τ| dt over all parts, per joint: they add up to 1, or are
    /// all 0 where no torque was needed.
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
