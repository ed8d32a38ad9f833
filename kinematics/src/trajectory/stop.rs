//! How a motion stops that nobody goes on with: planned and checked before it may be needed.
//!
//! Both joints go on along the straight line of their velocities, first as fast as they are, then slower. With
//! the speed v of the faster one and the time T, its jerk is −4v/T² for T/2 and 4v/T² for T/2, so its greatest
//! deceleration is 2v/T and its way vT/2. T is such that both joints keep their accelerations and their jerks, which have the
//! ratio to these that the tool's limits have.

use super::envelope::Envelope;
use super::error::ConstraintViolation;
use super::number::{max, min};
use super::reference::Reference;
use super::trajectory_segment::{Shape, TimeLaw, ToolOutput, TrajectorySegment};
use super::verify::RESERVE_ANGLE;
use crate::Scalar;
use crate::control::FrictionCompensation;
use crate::five_bar::{Joint, Side, Singularity, WorkspaceViolation};

/// T in times of the shortest one, tried in this order: a longer stop needs less torque and more way.
const LENGTHS: [f64; 3] = [1.05, 1.7, 2.7];
/// The greatest turn of the faster joint between two places at which a stop is checked [rad].
const TURN: f64 = 0.06;
/// The most places of a part, and the fewest.
const PLACES: [u32; 2] = [24, 2];
/// The share of the margin that a stop keeps besides, so that a motion can begin where it ends.
const RESERVE: f64 = 1.02;

/// Where a stop begins and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopStart<S> {
    /// θ1, θ4 [rad].
    pub angles: [S; 2],
    /// ω1, ω4 [rad/s].
    pub rates: [S; 2],
    /// The time for which they are kept [s].
    pub coast: S,
    /// The shortest time of either half of the stop [s].
    pub least_half: S,
    /// The arm's assembly mode.
    pub assembly: Side,
}

impl<S: Scalar> Envelope<S> {
    /// The segments of a stop from there: with constant speed, with more and with less deceleration. The arm keeps the joints'
    /// limits, their torques with friction, and the margin from all singularities along it.
    ///
    /// The poses are checked at places so near each other that what passes a limit between them is small against it.
    ///
    /// # Errors
    /// The first place found that violates a constraint on the longest stop that was tried.
    pub fn plan_stop(
        &self,
        start: &StopStart<S>,
        friction: &[FrictionCompensation<S>; 2],
        tag: u32,
        tool: ToolOutput<S>,
    ) -> Result<[TrajectorySegment<S>; 3], ConstraintViolation> {
        let shortest = self.stopping_time(start.rates);
        let mut refusal = None;
        for length in LENGTHS {
            let half = max(shortest * (S::from_f64(length) * S::HALF), start.least_half);
            let segments = parts(start, half, tag, tool);
            match self.check_stop(&segments, start.assembly, friction) {
                Ok(()) => return Ok(segments),
                Err(error) => refusal = Some(error),
            }
        }
        Err(refusal.unwrap_or(ConstraintViolation::Limits))
    }

    /// The shortest T [s].
    fn stopping_time(&self, rates: [S; 2]) -> S {
        let ratio = self.tool_motion.jerk / self.tool_motion.acceleration;
        let mut time = S::ZERO;
        for (rate, acceleration) in rates.into_iter().zip(self.joint_acceleration) {
            let per = rate.abs() / acceleration;
            time = max(time, max(per, (per / ratio).sqrt()) * S::TWO);
        }
        time
    }

    fn check_stop(
        &self,
        segments: &[TrajectorySegment<S>; 3],
        assembly: Side,
        friction: &[FrictionCompensation<S>; 2],
    ) -> Result<(), ConstraintViolation> {
        let mut before = None;
        for segment in segments {
            let duration = segment.duration();
            let turned = segment.path_state(duration).s - segment.path_state(S::ZERO).s;
            let [most, fewest] = PLACES;
            let (mut places, mut parts) = (1, S::ONE);
            while places < fewest || (places < most && turned > S::from_f64(TURN) * parts) {
                places += 1;
                parts += S::ONE;
            }
            let step = duration / parts;
            let mut time = S::ZERO;
            for _ in 0..=places {
                let reference = segment.evaluate(min(time, duration));
                let sines = self.check_joints(&reference, assembly, friction)?;
                self.check_sines(before.unwrap_or(sines), sines)?;
                before = Some(sines);
                time += step;
            }
        }
        Ok(())
    }

    /// Whether the sines of the arm's angles keep the margin between two places: between them a smooth one is below both
    /// by a small part of their difference only.
    fn check_sines(&self, before: [S; 3], now: [S; 3]) -> Result<(), ConstraintViolation> {
        let margin = self.workspace.margin * S::from_f64(RESERVE);
        let singularities = [Singularity::Leg1, Singularity::Leg4, Singularity::Parallel];
        for ((before, now), singularity) in before.into_iter().zip(now).zip(singularities) {
            let least = min(before, now) - (now - before).abs() * S::from_f64(0.25);
            let kept = least >= margin;
            if !kept {
                return Err(WorkspaceViolation::Margin(singularity).into());
            }
        }
        Ok(())
    }

    /// The sines of the legs' elbows and of links 2 and 3 at a reference of the joints, positive on the arm's own branch, if
    /// the joints keep their limits.
    fn check_joints(
        &self,
        reference: &Reference<S>,
        assembly: Side,
        friction: &[FrictionCompensation<S>; 2],
    ) -> Result<[S; 3], ConstraintViolation> {
        let Reference::Joint {
            angles: [theta1, theta4],
            rates: [omega1, omega4],
            accelerations: [alpha1, alpha4],
        } = *reference
        else {
            return Err(ConstraintViolation::Limits);
        };
        let (tool, mode) = (&self.workspace.tool, self.workspace.mode);
        let geometry = tool.geometry();
        let pose = geometry.forward(theta1, theta4, assembly)?;
        if let Some(limits) = &self.workspace.limits {
            let [range1, range4] = limits.ranges();
            let reserve = S::from_f64(RESERVE_ANGLE);
            for (angle, [least, greatest], joint) in [
                (theta1, range1, Joint::Joint1),
                (theta4, range4, Joint::Joint4),
            ] {
                let inside = least + reserve <= angle && angle <= greatest - reserve;
                if !inside {
                    return Err(WorkspaceViolation::Joint(joint).into());
                }
            }
        }
        let velocities = geometry.forward_velocities(&pose, omega1, omega4)?;
        let accelerations = geometry.forward_accelerations(&pose, &velocities, alpha1, alpha4)?;
        self.check_demand(&pose, &velocities, &accelerations, friction)?;
        let [sine1, sine4] = tool.elbow_sines(&pose);
        Ok([
            mode.elbow1.sign(sine1),
            mode.elbow4.sign(sine4),
            pose.sin32().abs(),
        ])
    }
}

/// The three parts of a stop with halves of this duration [s].
fn parts<S: Scalar>(
    start: &StopStart<S>,
    half: S,
    tag: u32,
    tool: ToolOutput<S>,
) -> [TrajectorySegment<S>; 3] {
    let [rate1, rate4] = start.rates;
    let speed = max(rate1.abs(), rate4.abs());
    let direction = match speed > S::ZERO {
        true => [rate1 / speed, rate4 / speed],
        false => [S::ZERO; 2],
    };
    let time = half + half;
    let (peak, jerk) = (speed * S::TWO / time, speed * S::TWO / (time * half));
    let coasted = speed * start.coast;
    // 5/12 of the whole time at full speed.
    let braked = coasted + speed * time * S::from_f64(5.0 / 12.0);
    let part = |law, duration| TrajectorySegment {
        shape: Shape::Joint {
            from: start.angles,
            direction,
        },
        law,
        duration,
        tag,
        tool,
    };
    [
        part(TimeLaw::new(S::ZERO, speed, S::ZERO, S::ZERO), start.coast),
        part(TimeLaw::new(coasted, speed, S::ZERO, -jerk), half),
        part(TimeLaw::new(braked, speed * S::HALF, -peak, jerk), half),
    ]
}
