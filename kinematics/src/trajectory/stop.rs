//! How a motion stops that nobody goes on with: planned and checked before it may be needed.
//!
//! The tool goes on along the straight line of its velocity, hardly slower at first, then slower until it rests. With the
//! speed v and the time T its speed is v (1 − 4x³ + 3x⁴), x = t/T, its way v T (x − x⁴ + ⅗x⁵). So its greatest deceleration is
//! 16/9 v/T at x = ⅔, and after a fifth of T it has 97 % of its speed. T is such that the joints keep about their accelerations, and
//! jerks that have the ratio to these that the tool's limits have; what they need on the way is checked.

use super::curve::Curve;
use super::envelope::Envelope;
use super::error::ConstraintViolation;
use super::hermite::ToolMotion;
use super::number::max;
use super::trajectory_segment::{TimeLaw, ToolOutput, TrajectorySegment};
use crate::control::FrictionCompensation;
use crate::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// T in times of the shortest one, tried in this order: a longer stop needs less torque and more way.
const LENGTHS: [f64; 3] = [1.1, 1.8, 3.0];
/// The greatest deceleration in times of v/T.
const DECELERATION: f64 = 16.0 / 9.0;
/// The greatest jerk in times of v/T².
const JERK: f64 = 12.0;
/// The least length of a stop [m]: where nothing moves, its parameter still goes on.
const LEAST: f64 = 1e-6;
/// The times at which the joints' demands are checked, besides the beginning.
const PLACES: u32 = 16;
/// The share of accelerations and torques that a stop uses there: what is greater between the places has the rest.
const USABLE: f64 = 0.97;

/// Where a stop begins, and how fast the joints are there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopStart<S> {
    /// The tool.
    pub tool: ToolMotion<S>,
    /// θ1, θ4 [rad].
    pub angles: [S; 2],
    /// ω1, ω4 [rad/s].
    pub rates: [S; 2],
    /// The shortest time of a stop [s].
    pub least: S,
}

impl<S: Scalar> Envelope<S> {
    /// The segment of a stop from there. The arm keeps the joints' limits and the margin from all singularities along the whole
    /// of it, as along any path, and the joints' speeds, accelerations and torques with friction at places so near each
    /// other that what passes a limit between them is small against it.
    ///
    /// # Errors
    /// The first place found that violates a constraint on the longest stop that was tried.
    pub fn plan_stop(
        &self,
        start: &StopStart<S>,
        friction: &[FrictionCompensation<S>; 2],
        tag: u32,
        tool: ToolOutput<S>,
    ) -> Result<TrajectorySegment<S>, ConstraintViolation> {
        let mut envelope = *self;
        let usable = S::from_f64(USABLE);
        envelope.joint_acceleration = self.joint_acceleration.map(|limit| limit * usable);
        if let Some(limits) = &mut envelope.torque {
            limits.torque = limits.torque.map(|limit| limit * usable);
        }
        let shortest = max(self.stopping_time(start.rates), start.least);
        let mut refusal = ConstraintViolation::Limits;
        for length in LENGTHS {
            let segment = stop(&start.tool, shortest * S::from_f64(length), tag, tool);
            match envelope.check_stop(&segment, start.angles, friction) {
                Ok(()) => return Ok(segment),
                Err(violation) => refusal = violation,
            }
        }
        Err(refusal)
    }

    /// The shortest T [s].
    fn stopping_time(&self, rates: [S; 2]) -> S {
        let ratio = self.tool_motion.jerk / self.tool_motion.acceleration;
        let mut time = S::ZERO;
        for (rate, acceleration) in rates.into_iter().zip(self.joint_acceleration) {
            let per = rate.abs() / acceleration;
            let jerky = (per * S::from_f64(JERK) / ratio).sqrt();
            time = max(time, max(per * S::from_f64(DECELERATION), jerky));
        }
        time
    }

    fn check_stop(
        &self,
        segment: &TrajectorySegment<S>,
        angles: [S; 2],
        friction: &[FrictionCompensation<S>; 2],
    ) -> Result<(), ConstraintViolation> {
        let Some(path) = super::timed::path_of(segment) else {
            return Err(ConstraintViolation::Limits);
        };
        self.verify_path(&path, Some(angles), |_, _| Ok(()))
            .map_err(|error| error.violation)?;
        let step = segment.duration() * S::from_f64(1.0 / f64::from(PLACES));
        let mut time = S::ZERO;
        for _ in 0..PLACES {
            time += step;
            self.check_reference(&segment.evaluate(time), friction)?;
        }
        Ok(())
    }
}

/// The stop of this duration [s].
fn stop<S: Scalar>(
    from: &ToolMotion<S>,
    duration: S,
    tag: u32,
    tool: ToolOutput<S>,
) -> TrajectorySegment<S> {
    let way = from.velocity * duration;
    // |dr/du| ≤ |vT|.
    let length = way.length() + S::from_f64(LEAST);
    let nothing = Vector2::zeros();
    let curve = Curve::Blend {
        coefficients: [
            from.position,
            way,
            nothing,
            nothing,
            -way,
            way * S::from_f64(0.6),
        ],
        inverse_length: S::ONE / length,
    };
    let law = TimeLaw::new(S::ZERO, length / duration, S::ZERO, S::ZERO);
    TrajectorySegment::along(curve, law, duration, tag, tool)
}
