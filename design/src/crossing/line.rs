//! The line of a crossing: where it meets the singularity, and what a motion along it needs.

use super::error::CrossingError;
use super::law::CrossingLaw;
use super::search::CrossingTask;
use fivebar_kinematics::five_bar::{Joint, JointLimits, Pose, Velocities};
use nalgebra::Vector2;

/// Steps of a line at whose ends it is checked.
const STEPS: usize = 400;
/// Halvings of the interval that holds the singularity: as many as a number has bits.
const HALVINGS: usize = 60;
/// The least |sin(θ3−θ2)| at which the torque is computed: it is f/sin, f being exact to 1e-15 N.
const NEAREST: f64 = 1e-5;

/// What a motion needs at most; pairs are of joint 1 and joint 4.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Needs {
    pub(super) torque: [f64; 2],
    pub(super) speed: [f64; 2],
    pub(super) acceleration: [f64; 2],
    /// Whether s goes forward, from 0 to 1.
    pub(super) forward: bool,
}

impl CrossingTask<'_> {
    /// C′.
    pub(super) fn along(&self) -> Vector2<f64> {
        self.to - self.from
    }

    pub(super) fn pose(&self, s: f64) -> Result<Pose<f64>, CrossingError> {
        let pose = self
            .arm
            .geometry()
            .inverse(self.from + self.along() * s, self.mode);
        pose.map_err(|error| CrossingError::Pose(s, error))
    }

    /// All velocities at ṡ.
    pub(super) fn velocities(
        &self,
        pose: &Pose<f64>,
        s: f64,
        s_dot: f64,
    ) -> Result<Velocities<f64>, CrossingError> {
        let velocities = self
            .arm
            .geometry()
            .inverse_velocities(pose, self.along() * s_dot);
        velocities.map_err(|error| CrossingError::Pose(s, error))
    }

    /// Checks poses and ranges along the line, and finds where sin(θ3−θ2) = 0.
    pub(super) fn singularity(&self) -> Result<f64, CrossingError> {
        let ranges = JointLimits::new(self.angle[0], self.angle[1]).ok();
        let mut found = Vec::new();
        let mut last = self.pose(0.0)?.sin32();
        for k in 0..=STEPS {
            let s = k as f64 / STEPS as f64;
            let pose = self.pose(s)?;
            for sine in [pose.sin21(), pose.sin34()] {
                if sine.abs() < self.elbow_margin {
                    return Err(CrossingError::Elbow(s, sine.abs()));
                }
            }
            let [theta1, _, _, theta4] = pose.angles();
            if let Some(Err(error)) = ranges.map(|ranges| ranges.angles_within(theta1, theta4)) {
                return Err(CrossingError::Range(s, error.joint()));
            }
            let sine = pose.sin32();
            if sine * last < 0.0 {
                found.push([s - 1.0 / STEPS as f64, s]);
            }
            if sine != 0.0 {
                last = sine;
            }
        }
        match found[..] {
            [] => Err(CrossingError::NoSingularity),
            [between] => self.halved(between),
            _ => Err(CrossingError::SeveralSingularities(found.len())),
        }
    }

    /// The zero of sin(θ3−θ2) within an interval, or next to its beginning.
    fn halved(&self, [mut low, mut high]: [f64; 2]) -> Result<f64, CrossingError> {
        let at_high = self.pose(high)?.sin32();
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.pose(middle)?.sin32() * at_high > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok(0.5 * (low + high))
    }

    /// What a law needs, at `samples` even times.
    pub(super) fn needs(&self, law: &CrossingLaw, samples: usize) -> Result<Needs, CrossingError> {
        let mut needs = Needs {
            forward: true,
            ..Needs::default()
        };
        for k in 0..=samples {
            let [s, s_dot, s_ddot] = law.at(k as f64 / samples as f64);
            if !(-1e-9..=1.0 + 1e-9).contains(&s) || s_dot < -1e-9 {
                needs.forward = false;
                return Ok(needs);
            }
            let pose = self.pose(s.clamp(0.0, 1.0))?;
            let velocities = self.velocities(&pose, s, s_dot)?;
            let geometry = self.arm.geometry();
            let accelerations =
                geometry.inverse_accelerations(&pose, &velocities, self.along() * s_ddot);
            let accelerations = accelerations.map_err(|error| CrossingError::Pose(s, error))?;
            let ([w1, _, _, w4], [a1, _, _, a4]) = (velocities.omega, accelerations.alpha);
            raise(&mut needs.speed, [w1, w4]);
            raise(&mut needs.acceleration, [a1, a4]);
            if pose.sin32().abs() < NEAREST {
                continue;
            }
            let torque =
                self.arm
                    .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros());
            let torque = torque.map_err(|error| CrossingError::Pose(s, error))?;
            let friction = self.friction([w1, w4]);
            raise(&mut needs.torque, [0, 1].map(|j| torque[j] + friction[j]));
        }
        Ok(needs)
    }

    /// The first limit of a joint that is not enough.
    pub(super) fn within(&self, needs: &Needs) -> Result<(), CrossingError> {
        for (j, joint) in [Joint::Joint1, Joint::Joint4].into_iter().enumerate() {
            let passed = |needed: [f64; 2], limit: [f64; 2]| {
                (needed[j] > limit[j]).then_some((needed[j], limit[j]))
            };
            if let Some((needed, limit)) = passed(needs.torque, self.torque) {
                return Err(CrossingError::Torque {
                    joint,
                    needed,
                    limit,
                });
            }
            if let Some((needed, limit)) = passed(needs.speed, self.speed) {
                return Err(CrossingError::Speed {
                    joint,
                    needed,
                    limit,
                });
            }
            if let Some((needed, limit)) = passed(needs.acceleration, self.acceleration) {
                return Err(CrossingError::Acceleration {
                    joint,
                    needed,
                    limit,
                });
            }
        }
        Ok(())
    }
}

fn raise(most: &mut [f64; 2], values: [f64; 2]) {
    for (most, value) in most.iter_mut().zip(values) {
        *most = most.max(value.abs());
    }
}
