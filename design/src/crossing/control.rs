//! Control of a crossing, after Pagis, Bouton, Briot and Martinet 2015.
//!
//! | \|sin(θ3−θ2)\| of the measured cranks | torque |
//! |---|---|
//! | above 0.3 | computed torque at the measured state, in the plan's assembly mode |
//! | below 0.2, the zone | the plan's, and a PD of the cranks: nothing there divides by the sine |
//! | between | both, in proportion |
//!
//! θ1 and θ4 are the same on either side of the singularity, so the assembly mode is that of the
//! plan, and the cranks do not show whether the arm went through: only a sensor or a push does.
//! The torque ends when a crank is 0.05 rad from the plan outside the zone, and when, after twice the
//! time that the plan takes in the zone, the arm is still there with a crank 0.01 rad from the plan: it is
//! stuck.

use super::error::CrossingError;
use super::search::{CrossingPlan, CrossingTask};
use fivebar_kinematics::five_bar::Side;
use nalgebra::Vector2;

/// |sin(θ3−θ2)| below which the arm is in the zone: computed torque divides by it.
const ZONE: f64 = 0.2;
/// |sin(θ3−θ2)| from which on computed torque alone acts.
const OUTSIDE: f64 = 0.3;
/// Bandwidth of computed torque, whose poles are both real and equal [rad/s].
const BANDWIDTH: f64 = 120.0;
/// Proportional gain of the cranks' PD in the zone [N·m/rad].
const STIFFNESS: f64 = 120.0;
/// Derivative gain of the cranks' PD in the zone [N·m·s/rad].
const DAMPING: f64 = 1.0;
/// The greatest error of a crank outside the zone [rad]: inside it the arm goes on.
const FOLLOWING_ERROR: f64 = 0.05;
/// The greatest error of a crank that stays in the zone [rad]: a plan may end there.
const RESTING_ERROR: f64 = 0.01;
/// The longest time in the zone, in times of the plan's.
const TIMEOUT_FACTOR: f64 = 2.0;
/// |sin(θ3−θ2)| below which the plan's torque is interpolated.
const NEAREST: f64 = 1e-3;
/// Coulomb's sign is smoothed as tanh(ω/ωs) [rad/s].
const SMOOTHING: f64 = 0.1;

/// The plan at one tick; pairs are of joint 1 and joint 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingSetpoint {
    /// C [m].
    pub tip: Vector2<f64>,
    /// θ [rad].
    pub theta: [f64; 2],
    /// ω [rad/s].
    pub omega: [f64; 2],
    /// α [rad/s²].
    pub alpha: [f64; 2],
    /// Torque with friction [N·m].
    pub torque: [f64; 2],
    /// sin(θ3−θ2).
    pub sine: f64,
    /// The assembly mode.
    pub assembly: Side,
}

/// The controller of one crossing.
#[derive(Clone, Debug)]
pub struct CrossingControl<'a> {
    task: &'a CrossingTask<'a>,
    setpoints: Vec<CrossingSetpoint>,
    /// Ticks in the zone so far, and the most.
    in_zone: usize,
    most_in_zone: usize,
    stuck: bool,
}

impl<'a> CrossingControl<'a> {
    /// The controller of a plan, for ticks of `period` [s].
    ///
    /// # Errors
    /// As [`CrossingTask::plan`].
    pub fn new(
        task: &'a CrossingTask<'a>,
        plan: &CrossingPlan,
        period: f64,
    ) -> Result<Self, CrossingError> {
        let ticks = (task.time / period).ceil() as usize;
        let setpoints = (0..=ticks).map(|tick| {
            let tau = (period * tick as f64 / task.time).min(1.0);
            task.setpoint(plan, tau)
        });
        let mut setpoints: Vec<CrossingSetpoint> = setpoints.collect::<Result<_, _>>()?;
        interpolate_torque(&mut setpoints);
        let planned = setpoints.iter().filter(|at| at.sine.abs() < ZONE).count();
        Ok(Self {
            task,
            setpoints,
            in_zone: 0,
            stuck: false,
            most_in_zone: (TIMEOUT_FACTOR * planned as f64) as usize,
        })
    }

    /// The plan at a tick; after its end, its end.
    pub fn setpoint(&self, tick: usize) -> &CrossingSetpoint {
        &self.setpoints[tick.min(self.setpoints.len() - 1)]
    }

    /// The number of ticks that an arm may be in the zone.
    pub fn most_in_zone(&self) -> usize {
        self.most_in_zone
    }

    /// The torque of a tick [N·m] from the measured angles and speeds of the cranks; none from the
    /// tick on in which the arm is found stuck.
    pub fn torque(&mut self, tick: usize, theta: [f64; 2], omega: [f64; 2]) -> Option<[f64; 2]> {
        let sine = self.sine(theta);
        let at = *self.setpoint(tick);
        let farther = |most: f64| (0..2).any(|j| (at.theta[j] - theta[j]).abs() > most);
        if sine < ZONE {
            self.in_zone += 1;
            self.stuck |= self.in_zone > self.most_in_zone && farther(RESTING_ERROR);
        } else {
            self.in_zone = 0;
            self.stuck |= farther(FOLLOWING_ERROR);
        }
        if self.stuck {
            return None;
        }
        let (e, e_dot) = (
            [0, 1].map(|j| at.theta[j] - theta[j]),
            [0, 1].map(|j| at.omega[j] - omega[j]),
        );
        let by_plan = [0, 1].map(|j| at.torque[j] + STIFFNESS * e[j] + DAMPING * e_dot[j]);
        let share = ((sine - ZONE) / (OUTSIDE - ZONE)).clamp(0.0, 1.0);
        let torque = match self.computed(&at, theta, omega, [e, e_dot]) {
            Some(computed) if share > 0.0 => {
                [0, 1].map(|j| share * computed[j] + (1.0 - share) * by_plan[j])
            }
            _ => by_plan,
        };
        Some([0, 1].map(|j| torque[j].clamp(-self.task.torque[j], self.task.torque[j])))
    }

    /// |sin(θ3−θ2)| of these cranks; 0 where B and D are farther apart than links 2 and 3 reach.
    fn sine(&self, [theta1, theta4]: [f64; 2]) -> f64 {
        let geometry = self.task.arm.geometry();
        let pose = geometry.forward(theta1, theta4, Side::Left);
        pose.map_or(0.0, |pose| pose.sin32().abs())
    }

    /// Computed torque; none where the arm has no such pose.
    fn computed(
        &self,
        at: &CrossingSetpoint,
        theta: [f64; 2],
        omega: [f64; 2],
        [e, e_dot]: [[f64; 2]; 2],
    ) -> Option<[f64; 2]> {
        let arm = self.task.arm;
        let geometry = arm.geometry();
        let alpha =
            [0, 1].map(|j| at.alpha[j] + BANDWIDTH * BANDWIDTH * e[j] + 2.0 * BANDWIDTH * e_dot[j]);
        let pose = geometry.forward(theta[0], theta[1], at.assembly).ok()?;
        let velocities = geometry
            .forward_velocities(&pose, omega[0], omega[1])
            .ok()?;
        let accelerations = geometry
            .forward_accelerations(&pose, &velocities, alpha[0], alpha[1])
            .ok()?;
        let torque = arm
            .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())
            .ok()?;
        let friction = self.task.friction(at.omega);
        Some([0, 1].map(|j| torque[j] + friction[j]))
    }
}

impl CrossingTask<'_> {
    /// The torque of friction at joint speeds [N·m].
    pub(super) fn friction(&self, omega: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|j| self.viscous[j] * omega[j] + self.coulomb[j] * (omega[j] / SMOOTHING).tanh())
    }

    fn setpoint(&self, plan: &CrossingPlan, tau: f64) -> Result<CrossingSetpoint, CrossingError> {
        let [s, s_dot, s_ddot] = plan.law.at(tau);
        let at = |error| CrossingError::Pose(s, error);
        let pose = self.pose(s.clamp(0.0, 1.0))?;
        let velocities = self.velocities(&pose, s, s_dot)?;
        let geometry = self.arm.geometry();
        let accelerations = geometry
            .inverse_accelerations(&pose, &velocities, self.along() * s_ddot)
            .map_err(at)?;
        let sine = pose.sin32();
        let torque = if sine.abs() < NEAREST {
            [f64::NAN; 2]
        } else {
            self.arm
                .inverse_dynamics(&pose, &velocities, &accelerations, Vector2::zeros())
                .map_err(at)?
        };
        let ([w1, _, _, w4], [a1, _, _, a4]) = (velocities.omega, accelerations.alpha);
        let friction = self.friction([w1, w4]);
        let [theta1, _, _, theta4] = pose.angles();
        Ok(CrossingSetpoint {
            tip: pose.c,
            theta: [theta1, theta4],
            omega: [w1, w4],
            alpha: [a1, a4],
            torque: [0, 1].map(|j| torque[j] + friction[j]),
            sine,
            assembly: plan.assembly[usize::from(s > plan.s_c)],
        })
    }
}

/// Bridges the ticks next to the singularity, where the torque is 0/0, by straight lines.
fn interpolate_torque(setpoints: &mut [CrossingSetpoint]) {
    let known = |at: &CrossingSetpoint| at.torque.iter().all(|torque| torque.is_finite());
    let gaps: Vec<usize> = (0..setpoints.len())
        .filter(|&k| !known(&setpoints[k]))
        .collect();
    let (Some(&first), Some(&last)) = (gaps.first(), gaps.last()) else {
        return;
    };
    let (before, after) = (first.saturating_sub(1), (last + 1).min(setpoints.len() - 1));
    let ends = [setpoints[before].torque, setpoints[after].torque];
    for (k, at) in setpoints.iter_mut().enumerate().take(last + 1).skip(first) {
        let share = (k - before) as f64 / (after - before) as f64;
        at.torque = [0, 1].map(|j| ends[0][j] + share * (ends[1][j] - ends[0][j]));
    }
}
