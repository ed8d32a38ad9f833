//! Whether learning converges, from the frequency response of the loop.
//!
//! A shift c of the set-point moves the arm by T c. The controller feeds the torque of the set-point's motion forward by
//! its model M̂ of the arm's M, so with the loop's sensitivity S
//!
//! 1 − T = S (1 − M⁻¹ M̂).
//!
//! Of what a run shows, the share γ is added to the shift, and the filter Q smooths the sum. What is not yet learnt then
//! shrinks from run to run by the factor
//!
//! ρ(ω) = Q(ω) (1 − γ + γ |S(ω)| ‖1 − M⁻¹ M̂‖),
//!
//! which has to be below 1 at every frequency, for every arm that may be meant. |S| is 1/|1 + λ| at the nearer one of
//! both loci λ.

use super::LearningError;
use fivebar_design::servo::{BusServo, Gains, LoopPoint, Servo};
use fivebar_files::robot::{BusServos, Robot};
use fivebar_files::scenario::ControlLaw;
use nalgebra::Matrix2;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The share γ of an error that a run adds to the shift.
pub(super) const SHARE: f64 = 0.8;
/// What is left of an error after a run, at most, in the band that is learnt.
const MOST_LEFT: f64 = 0.9;
/// The widest band of the filter [Hz]: of knots in even steps of 4 ms it is nearly all that they hold.
const WIDEST: f64 = 80.0;
/// The narrowest band with which learning is of use [Hz].
const NARROWEST: f64 = 2.0;

/// The filter Q, a Gaussian over time: its gain is 1 at rest and falls at every frequency, without a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Where its gain is a half [Hz].
    pub half: f64,
    /// The greatest factor by which an error shrinks in a run.
    pub contraction: f64,
}

impl Filter {
    /// Standard deviation of the Gaussian [s].
    pub(super) fn deviation(half: f64) -> f64 {
        (2.0 * 2.0_f64.ln()).sqrt() / (TAU * half)
    }

    /// The gain at ω [rad/s].
    fn gain(half: f64, omega: f64) -> f64 {
        let x = omega * Self::deviation(half);
        (-0.5 * x * x).exp()
    }
}

/// |1 − T| at frequencies [rad/s], at the worst pose of the worst arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Response(Vec<(f64, f64)>);

impl Response {
    /// Of a robot under a control law, for −20 to +30 % of the links' inertia and 0 to twice the payload.
    ///
    /// # Errors
    /// The robot has no masses, or its settings are refused.
    pub fn new(robot: &Robot, law: ControlLaw) -> Result<Self, LearningError> {
        let pid = match law.is_computed_torque() {
            true => None,
            false => Some(pid(robot)?),
        };
        if let Some(servos) = robot.bus_servos()? {
            return Self::through_bus(robot, &servos, pid.as_ref());
        }
        let arms = robot.unlike_servos()?;
        let models = robot.servos()?;
        let points: Option<Vec<Vec<(f64, f64)>>> = models
            .par_iter()
            .zip(&arms)
            .map(|((_, model), arms)| {
                let (law, model) = match &pid {
                    None => (model.law(&robot.gains()), model.mass_matrix),
                    Some((gains, inertia)) => {
                        let joints = Servo::new(*inertia, model.drives, model.period);
                        (joints.law(gains), *inertia)
                    }
                };
                let of = |arm: &Servo| {
                    if arm.spectral_radius(&law, 1.0) >= 1.0 {
                        return None;
                    }
                    missed(&arm.loci(&law), &arm.mass_matrix, &model)
                };
                let arms: Option<Vec<_>> = arms.iter().map(of).collect();
                Some(arms?.concat())
            })
            .collect();
        Self::of_all(points)
    }

    /// The same through a bus. The springs and dampers of the drives follow the shifted motion, too: S is the sensitivity of the
    /// controller's loop times what they leave.
    fn through_bus(
        robot: &Robot,
        servos: &BusServos,
        pid: Option<&(Gains, Matrix2<f64>)>,
    ) -> Result<Self, LearningError> {
        let points: Option<Vec<Vec<(f64, f64)>>> = servos
            .servos
            .par_iter()
            .zip(&servos.unlike)
            .map(|((_, servo), arms)| {
                let gains = robot.gains();
                let (gains, mass_matrix) =
                    pid.map_or((&gains, servo.mass_matrix), |(gains, of)| (gains, *of));
                let model = BusServo {
                    mass_matrix,
                    ..*servo
                };
                let law = model.law(gains);
                let of = |arm: &BusServo| {
                    let loci = arm.loci(&law);
                    BusServo::margins(&loci)?;
                    let mut points = missed(&loci, &arm.mass_matrix, &mass_matrix)?;
                    for (omega, missed) in &mut points {
                        *missed *= arm.left_by_springs(*omega);
                    }
                    Some(points)
                };
                let arms: Option<Vec<_>> = arms.iter().map(of).collect();
                Some(arms?.concat())
            })
            .collect();
        Self::of_all(points)
    }

    fn of_all(points: Option<Vec<Vec<(f64, f64)>>>) -> Result<Self, LearningError> {
        let points = points.ok_or(LearningError::Unstable)?;
        Ok(Self(points.concat()))
    }

    /// The greatest factor by which an error shrinks, with a filter of this band [Hz].
    pub fn contraction(&self, half: f64) -> f64 {
        let factor = |&(omega, unlike): &(f64, f64)| {
            Filter::gain(half, omega) * (1.0 - SHARE + SHARE * unlike)
        };
        self.0.iter().map(factor).fold(0.0, f64::max)
    }

    /// The filter of the widest band with which learning converges.
    ///
    /// # Errors
    /// There is none.
    pub fn filter(&self) -> Result<Filter, LearningError> {
        let mut half = WIDEST;
        while half >= NARROWEST {
            let contraction = self.contraction(half);
            if contraction <= MOST_LEFT {
                return Ok(Filter { half, contraction });
            }
            half *= 0.9;
        }
        Err(LearningError::Diverges(self.contraction(NARROWEST)))
    }
}

/// |1 − T| along these loci, of an arm whose controller has another model [kg·m²].
fn missed(loci: &[LoopPoint], arm: &Matrix2<f64>, model: &Matrix2<f64>) -> Option<Vec<(f64, f64)>> {
    let unlike = Matrix2::identity() - arm.try_inverse()? * model;
    let unlike = unlike.singular_values().max();
    let points = loci.iter().map(|point| {
        let [one, other] = point.loci.map(|locus| (locus + 1.0).norm());
        (point.omega, unlike / one.min(other))
    });
    Some(points.collect())
}

/// Gains and inertia of independent joints [kg·m²].
fn pid(robot: &Robot) -> Result<(Gains, Matrix2<f64>), LearningError> {
    let settings = robot.pid_settings()?.check()?;
    let control = robot.rigid_control;
    let gains = Gains {
        bandwidth: control.bandwidth,
        damping: control.damping,
        integral_rate: control.integral_rate,
        observer_bandwidth: control.observer_bandwidth,
        current_bandwidth: control.current_bandwidth,
        belts: None,
    };
    let inertia = settings.nominal_inertia().map(f64::from);
    Ok((gains, Matrix2::from_diagonal(&inertia.into())))
}
