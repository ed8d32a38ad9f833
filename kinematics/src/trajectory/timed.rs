//! The check of a segment of motion whose time law was made elsewhere.
//!
//! The geometry is proven along its whole length. Speeds, accelerations and torques are those of the
//! motion itself, with friction and without reserve, at places so near each other that what passes a
//! limit between them is rounding: at most [`INTERVAL`] and [`TURN`] apart.

use super::curve::Curve;
use super::envelope::Envelope;
use super::error::{ConstraintViolation, PathError, WithJoints};
use super::path_segment::PathSegment;
use super::reference::Reference;
use super::trajectory_segment::{PathState, TrajectorySegment};
use crate::control::FrictionCompensation;
use crate::five_bar::Joint;
use crate::{PlanarVector, Scalar};

/// The longest time between two places at which the motion is checked [s].
const INTERVAL: f64 = 2.5e-4;
/// The greatest turn of the tool's direction between them [rad]. Of what turns with it, the most
/// between them is greater by an eighth of its square.
const TURN: f64 = 0.1;
/// The most places.
const PLACES: u32 = 320;
/// The longest such segment [s].
const LONGEST: f64 = 64e-3;

impl<S: Scalar> Envelope<S> {
    /// Checks a segment along a curve with its time law: the whole path is within the workspace, it
    /// goes forward, and no joint passes its speed, its acceleration or its torque. The limits of
    /// the tool's motion do not apply. Returns the reference at its end.
    ///
    /// # Errors
    /// The first place found that violates a constraint; [`ConstraintViolation::Limits`] for a
    /// segment that is no motion along a curve, that goes backward, that lasts more than 64 ms, or
    /// that turns too much in its time (6 rad in 64 ms, 31 in 1 ms) to be checked in bounded time.
    pub fn check_timed(
        &self,
        segment: &TrajectorySegment<S>,
        friction: &[FrictionCompensation<S>; 2],
    ) -> Result<Reference<S>, PathError<S>> {
        self.check_timed_from(segment, friction, None)
            .map(|(end, _)| end)
    }

    /// As [`Self::check_timed`], from the joint angles θ1, θ4 [rad] on, as [`Self::check_from`] has them. Returns also those at
    /// the end.
    ///
    /// # Errors
    /// As [`Self::check_timed`].
    pub fn check_timed_from(
        &self,
        segment: &TrajectorySegment<S>,
        friction: &[FrictionCompensation<S>; 2],
        joints: Option<[S; 2]>,
    ) -> WithJoints<Reference<S>, S> {
        let duration = segment.duration();
        let end = segment.path_state(duration);
        let fail = |violation| PathError {
            fraction: S::ZERO,
            point: position(&segment.evaluate(S::ZERO)),
            violation,
        };
        let Some(path) = path_of(segment) else {
            return Err(fail(ConstraintViolation::Limits));
        };
        if duration > S::from_f64(LONGEST) {
            return Err(fail(ConstraintViolation::Limits));
        }
        let joints = self.verify_path(&path, joints, |_, _| Ok(()))?;
        let mut last = segment.path_state(S::ZERO).s;
        let mut time = S::ZERO;
        for _ in 0..PLACES {
            let state = if time < duration {
                segment.path_state(time)
            } else {
                end
            };
            let reference = segment.reference(state);
            let here = |violation| PathError {
                fraction: time / duration,
                point: position(&reference),
                violation,
            };
            if state.s + S::from_f64(1e-7) < last {
                return Err(here(ConstraintViolation::Limits));
            }
            last = state.s;
            self.check_reference(&reference, friction).map_err(here)?;
            if time >= duration {
                return Ok((reference, joints));
            }
            time += step(&reference);
            if time > duration {
                time = duration;
            }
        }
        Err(fail(ConstraintViolation::Limits))
    }

    /// Whether the joints' speeds, accelerations and torques at a reference are within their limits.
    pub(super) fn check_reference(
        &self,
        reference: &Reference<S>,
        friction: &[FrictionCompensation<S>; 2],
    ) -> Result<(), ConstraintViolation> {
        let Reference::Tool {
            position,
            velocity,
            acceleration,
        } = *reference
        else {
            return Err(ConstraintViolation::Limits);
        };
        let tool = &self.workspace.tool;
        let pose = tool.inverse(position, self.workspace.mode)?;
        let velocities = tool.inverse_velocities(&pose, velocity)?;
        let accelerations = tool.inverse_accelerations(&pose, &velocities, acceleration)?;
        let ([w1, _, _, w4], [a1, _, _, a4]) = (velocities.omega, accelerations.alpha);
        let torque = match &self.torque {
            None => [S::ZERO; 2],
            Some(limits) => limits.arm.inverse_dynamics(
                &pose,
                &velocities,
                &accelerations,
                nalgebra::Vector2::zeros(),
            )?,
        };
        let joints = [Joint::Joint1, Joint::Joint4];
        for (j, (joint, (speed, acceleration))) in
            joints.into_iter().zip([(w1, a1), (w4, a4)]).enumerate()
        {
            let within = |value: S, limit: S| value.abs() <= limit;
            if !within(speed, self.joint_speed[j]) {
                return Err(ConstraintViolation::JointSpeed(joint));
            }
            if !within(acceleration, self.joint_acceleration[j]) {
                return Err(ConstraintViolation::JointAcceleration(joint));
            }
            if let Some(limits) = &self.torque
                && !within(torque[j] + friction[j].torque(speed), limits.torque[j])
            {
                return Err(ConstraintViolation::MotionTorque(joint));
            }
        }
        Ok(())
    }
}

/// The time to the next place [s].
fn step<S: Scalar>(reference: &Reference<S>) -> S {
    let interval = S::from_f64(INTERVAL);
    let Reference::Tool {
        velocity,
        acceleration,
        ..
    } = *reference
    else {
        return interval;
    };
    // The direction turns at the rate |v × a| / |v|². Near rest that is rounding.
    let turn = velocity.cross_z(acceleration).abs() * interval;
    let square = velocity.length_squared();
    let most = square * S::from_f64(TURN);
    if square > S::from_f64(1e-6) && turn > most {
        interval * (most / turn)
    } else {
        interval
    }
}

/// The path that a segment covers; a whole blend, because its parts are no curves of their own.
pub(super) fn path_of<S: Scalar>(segment: &TrajectorySegment<S>) -> Option<PathSegment<S>> {
    let curve = segment.curve()?;
    let [from, to] = [S::ZERO, segment.duration()].map(|t| segment.path_state(t));
    let rises = |PathState { s: to, .. }: PathState<S>, from: S| from <= to;
    if !(segment.duration() > S::ZERO && from.s.is_finite() && rises(to, from.s)) {
        return None;
    }
    let length = to.s - from.s;
    match curve {
        Curve::Blend { inverse_length, .. } => {
            let whole = S::ONE / *inverse_length;
            let within = -S::from_f64(1e-6) <= from.s && to.s <= whole + S::from_f64(1e-6);
            (whole.is_finite() && within).then(|| PathSegment::new(*curve, whole))
        }
        _ => Some(PathSegment::new(curve.advanced(from.s), length)),
    }
}

fn position<S: Scalar>(reference: &Reference<S>) -> nalgebra::Vector2<S> {
    match reference {
        Reference::Tool { position, .. } => *position,
        Reference::Joint { .. } => nalgebra::Vector2::zeros(),
    }
}
