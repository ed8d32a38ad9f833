//! The law of least peak torque: vc and τc on a grid.
//!
//! s̈c = −(f0(vc) + N·C″ vc²)/(N·C′) satisfies the condition f = 0; on a line C″ = 0.

use super::condition::CrossingCondition;
use super::error::CrossingError;
use super::law::CrossingLaw;
use fivebar_kinematics::PlanarVector;
use fivebar_kinematics::dynamics::Arm;
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use nalgebra::Vector2;

/// A crossing along a line, from rest to rest. Pairs of numbers are of joint 1 and joint 4.
#[derive(Clone, Debug)]
pub struct CrossingTask<'a> {
    /// The arm.
    pub arm: &'a Arm<f64>,
    /// The sides to which its elbows turn.
    pub mode: WorkingMode,
    /// Viscous friction [N·m·s/rad].
    pub viscous: [f64; 2],
    /// Coulomb friction [N·m].
    pub coulomb: [f64; 2],
    /// Greatest torque [N·m].
    pub torque: [f64; 2],
    /// Greatest speed [rad/s].
    pub speed: [f64; 2],
    /// Greatest acceleration [rad/s²].
    pub acceleration: [f64; 2],
    /// Least and greatest angle [rad].
    pub angle: [[f64; 2]; 2],
    /// Least |sin| at the elbows.
    pub elbow_margin: f64,
    /// Drag at the tip that the crossing must overcome [N].
    pub drag: f64,
    /// Where the line begins [m].
    pub from: Vector2<f64>,
    /// Where it ends [m].
    pub to: Vector2<f64>,
    /// tf [s].
    pub time: f64,
}

/// A planned crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossingPlan {
    /// The time at which the arm is in the singularity [s].
    pub t_c: f64,
    /// The share of the line at which it is.
    pub s_c: f64,
    /// ṡ there [1/s].
    pub s_dot_c: f64,
    /// s̈ there [1/s²].
    pub s_ddot_c: f64,
    /// N and f0 there.
    pub condition: CrossingCondition,
    /// f there [N]: 0 but for rounding.
    pub value: f64,
    /// The motion.
    pub law: CrossingLaw,
    /// Peak torque of joint 1 and joint 4 [N·m], with friction.
    pub peak_torque: [f64; 2],
    /// The assembly mode before and after.
    pub assembly: [Side; 2],
}

/// The range of ṡc tf that is searched [1]: 1 would be the mean rate of the whole crossing.
const RATES: [f64; 2] = [0.8, 4.0];
/// The range of τc = tc/tf that is searched [1]: the middle of the crossing, so that time is left to
/// accelerate before and to brake after.
const SHARES: [f64; 2] = [0.35, 0.65];
/// Steps of the two ranges: the second grid is searched if the first holds no law.
const GRIDS: [[usize; 2]; 2] = [[16, 6], [64, 30]];
/// Samples of a candidate.
const COARSE: usize = 240;
/// Samples of the result, which is checked again.
const FINE: usize = 2000;
/// The least N·C′/(|N||C′|).
const LEAST_COSINE: f64 = 0.05;
/// |sin(θ3−θ2)| within which the drag acts against the momentum alone.
const DRAG_ZONE: f64 = 0.05;
/// Points of the line at which the zone's share of it is counted: to 1/400.
const DRAG_SAMPLES: i32 = 400;

impl CrossingTask<'_> {
    /// The crossing that needs the least torque.
    ///
    /// # Errors
    /// [`CrossingError`]: the line, the direction, a limit or the drag forbids it.
    pub fn plan(&self) -> Result<CrossingPlan, CrossingError> {
        self.check()?;
        let s_c = self.singularity()?;
        let mut refusal = CrossingError::NoLaw;
        for grid in GRIDS {
            match self.least_torque(s_c, grid) {
                Ok(plan) => {
                    self.check_drag(&plan)?;
                    return Ok(plan);
                }
                Err(error) => refusal = error,
            }
        }
        Err(refusal)
    }

    /// The plan of a grid with the least peak torque.
    fn least_torque(&self, s_c: f64, steps: [usize; 2]) -> Result<CrossingPlan, CrossingError> {
        let mut best: Option<(f64, CrossingPlan)> = None;
        let mut refusal: Option<(f64, CrossingError)> = None;
        for rate in even(RATES, steps[0]) {
            for share in even(SHARES, steps[1]) {
                let Some(plan) = self.candidate(s_c, rate / self.time, share)? else {
                    continue;
                };
                let needs = self.needs(&plan.law, COARSE)?;
                if !needs.forward {
                    continue;
                }
                let peak = needs.torque[0].max(needs.torque[1]);
                match self.within(&needs) {
                    Ok(()) if best.is_none_or(|(least, _)| peak < least) => {
                        best = Some((peak, plan));
                    }
                    Err(error) if refusal.is_none_or(|(least, _)| peak < least) => {
                        refusal = Some((peak, error));
                    }
                    _ => {}
                }
            }
        }
        let Some((_, mut plan)) = best else {
            return Err(refusal.map_or(CrossingError::NoLaw, |(_, error)| error));
        };
        let needs = self.needs(&plan.law, FINE)?;
        self.within(&needs)?;
        plan.peak_torque = needs.torque;
        Ok(plan)
    }

    fn check(&self) -> Result<(), CrossingError> {
        let positive = [
            &[self.time][..],
            &self.torque,
            &self.speed,
            &self.acceleration,
        ]
        .concat();
        let valid = positive.iter().all(|&value| value > 0.0) && self.time.is_finite();
        let length = self.along().norm();
        if length == 0.0 {
            return Err(CrossingError::SamePoint);
        }
        if valid && length > 0.0 && length.is_finite() && self.drag >= 0.0 {
            Ok(())
        } else {
            Err(CrossingError::Value)
        }
    }

    /// The crossing with ṡc at τc; none without a law. Its peak torque is still to be found.
    fn candidate(
        &self,
        s_c: f64,
        s_dot_c: f64,
        tau_c: f64,
    ) -> Result<Option<CrossingPlan>, CrossingError> {
        let pose = self.pose(s_c)?;
        let velocities = self.velocities(&pose, s_c, s_dot_c)?;
        let condition = CrossingCondition::new(self.arm, &pose, &velocities);
        let (n, along) = (condition.n, self.along());
        let cosine = n.dot(&along) / (n.norm() * along.norm());
        if cosine.abs() < LEAST_COSINE {
            return Err(CrossingError::Direction(cosine));
        }
        let s_ddot_c = -condition.f0 / n.dot(&along);
        let Some(law) = CrossingLaw::through(self.time, tau_c, [s_c, s_dot_c, s_ddot_c]) else {
            return Ok(None);
        };
        let [_, _, s_ddot] = law.at(tau_c);
        Ok(Some(CrossingPlan {
            t_c: tau_c * self.time,
            s_c,
            s_dot_c,
            s_ddot_c,
            condition,
            value: condition.value(along * s_ddot),
            law,
            peak_torque: [0.0; 2],
            assembly: [self.pose(0.0)?.assembly(), self.pose(1.0)?.assembly()],
        }))
    }

    /// ½|N·n2|(v·n2)² against the work of the drag within the zone.
    fn check_drag(&self, plan: &CrossingPlan) -> Result<(), CrossingError> {
        let n2 = self.pose(plan.s_c)?.u2.perpendicular();
        let speed = self.along().dot(&n2) * plan.s_dot_c;
        let energy = 0.5 * plan.condition.n.dot(&n2).abs() * speed * speed;
        let mut inside = 0;
        for k in 0..DRAG_SAMPLES {
            let pose = self.pose((f64::from(k) + 0.5) / f64::from(DRAG_SAMPLES))?;
            inside += i32::from(pose.sin32().abs() < DRAG_ZONE);
        }
        let work = self.drag * self.along().norm() * f64::from(inside) / f64::from(DRAG_SAMPLES);
        if energy > work {
            Ok(())
        } else {
            Err(CrossingError::TooSlow(energy, work))
        }
    }
}

/// The ends of `count` even steps of a range.
fn even([least, greatest]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    (0..=count).map(move |k| least + (greatest - least) * k as f64 / count as f64)
}
