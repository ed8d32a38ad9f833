//! How fast a path segment may be passed.
//!
//! The tool's own limits are shared out in [`shares`](super::shares). The driven joints follow with
//! θ̇ = θ′ ṡ, θ̈ = θ″ ṡ² + θ′ s̈, and their torques with τ = τ_g + τ_v ṡ² + τ_a s̈: gravity's, that of
//! passing at unit speed, that of unit acceleration from rest. Of the acceleration, and of the
//! torque that gravity leaves, ṡ² and s̈ get half each, and what the other does not need of its half.
//! θ′, θ″ and τ are sampled while the path is verified, with short steps near singularities; a
//! reserve of a twentieth covers the places between the samples.

use super::curve::CurvePoint;
use super::envelope::Envelope;
use super::error::ConstraintViolation;
use super::number::{max, min};
use super::ramp::MotionLimits;
use crate::Scalar;
use crate::five_bar::{Accelerations, Joint, Pose, PoseError, Velocities, WorkspaceViolation};
use nalgebra::Vector2;

/// The share of the limits that is used; the rest is the reserve.
const USABLE: f64 = 0.95;

/// The greatest demands that passing a path makes on the driven joints.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointDemand<S> {
    /// |θ′| of each joint [rad/m].
    rate: [S; 2],
    /// |θ″| [rad/m²].
    bend: [S; 2],
    /// |τ_v| over the torque that gravity leaves [s²/m²].
    passing: S,
    /// |τ_a| over it [s²/m].
    starting: S,
}

impl<S: Scalar> JointDemand<S> {
    pub(super) fn none() -> Self {
        Self {
            rate: [S::ZERO; 2],
            bend: [S::ZERO; 2],
            passing: S::ZERO,
            starting: S::ZERO,
        }
    }

    /// Takes a place on a path of the tool into account.
    pub(super) fn add_path(
        &mut self,
        envelope: &Envelope<S>,
        point: &CurvePoint<S>,
        pose: &Pose<S>,
    ) -> Result<(), ConstraintViolation> {
        let tool = &envelope.workspace.tool;
        let solve = || {
            let rest = tool.inverse_velocities(pose, Vector2::zeros())?;
            let passing = tool.inverse_velocities(pose, point.tangent)?;
            Ok((
                rest,
                tool.inverse_accelerations(pose, &rest, point.tangent)?,
                passing,
                tool.inverse_accelerations(pose, &passing, point.curvature)?,
            ))
        };
        let (rest, starting, passing, bending) = solve().map_err(no_pose)?;
        self.add(envelope, pose, (&rest, &starting), (&passing, &bending))
    }

    /// Takes a place on a joint move into account, each joint turning `direction` of it.
    pub(super) fn add_joint_path(
        &mut self,
        envelope: &Envelope<S>,
        [d1, d4]: [S; 2],
        pose: &Pose<S>,
    ) -> Result<(), ConstraintViolation> {
        let geometry = envelope.workspace.tool.geometry();
        let solve = || {
            let rest = geometry.forward_velocities(pose, S::ZERO, S::ZERO)?;
            let passing = geometry.forward_velocities(pose, d1, d4)?;
            Ok((
                rest,
                geometry.forward_accelerations(pose, &rest, d1, d4)?,
                passing,
                geometry.forward_accelerations(pose, &passing, S::ZERO, S::ZERO)?,
            ))
        };
        let (rest, starting, passing, bending) = solve().map_err(no_pose)?;
        self.add(envelope, pose, (&rest, &starting), (&passing, &bending))
    }

    fn add(
        &mut self,
        envelope: &Envelope<S>,
        pose: &Pose<S>,
        (rest, starting): (&Velocities<S>, &Accelerations<S>),
        (passing, bending): (&Velocities<S>, &Accelerations<S>),
    ) -> Result<(), ConstraintViolation> {
        let [w1, _, _, w4] = passing.omega;
        let [a1, _, _, a4] = bending.alpha;
        self.rate = greater(self.rate, [w1, w4]);
        self.bend = greater(self.bend, [a1, a4]);
        let Some(limits) = &envelope.torque else {
            return Ok(());
        };
        let nothing = Accelerations {
            alpha: [S::ZERO; 4],
            c: Vector2::zeros(),
        };
        let torque = |velocities, accelerations| {
            limits
                .arm
                .inverse_dynamics(pose, velocities, accelerations, Vector2::zeros())
                .map_err(no_pose)
        };
        let gravity = torque(rest, &nothing)?;
        let start = torque(rest, starting)?;
        let pass = torque(passing, bending)?;
        let joints = [Joint::Joint1, Joint::Joint4].into_iter();
        for ((((joint, limit), gravity), start), pass) in
            joints.zip(limits.torque).zip(gravity).zip(start).zip(pass)
        {
            let usable = limit * S::from_f64(USABLE) - gravity.abs();
            if usable <= S::ZERO {
                return Err(ConstraintViolation::Torque(joint));
            }
            self.starting = max(self.starting, (start - gravity).abs() / usable);
            self.passing = max(self.passing, (pass - gravity).abs() / usable);
        }
        Ok(())
    }

    /// `limits` tightened until the joints are within their limits too; `None` where a
    /// limit is not a positive finite number.
    pub(super) fn within(
        &self,
        limits: &MotionLimits<S>,
        envelope: &Envelope<S>,
    ) -> Option<MotionLimits<S>> {
        let mut limits = *limits;
        let usable = S::from_f64(USABLE);
        for (((rate, bend), speed), acceleration) in self
            .rate
            .into_iter()
            .zip(self.bend)
            .zip(envelope.joint_speed)
            .zip(envelope.joint_acceleration)
        {
            limits.speed = bounded_by(limits.speed, speed * usable, rate);
            share(&mut limits, acceleration * usable, bend, rate);
        }
        share(&mut limits, S::ONE, self.passing, self.starting);
        limits.are_valid().then_some(limits)
    }

    /// The limits of a joint move, at `share` of the greatest joint speeds; the jerk is
    /// `ratio` [1/s] times the acceleration.
    pub(super) fn joint_move_limits(
        &self,
        share: S,
        ratio: S,
        envelope: &Envelope<S>,
    ) -> Option<MotionLimits<S>> {
        let fastest = |[first, second]: [S; 2]| max(first, second);
        let acceleration = fastest(envelope.joint_acceleration);
        // The joint that turns further turns at ṡ, so no limit is above the greater limit.
        let mut limits = self.within(
            &MotionLimits {
                speed: fastest(envelope.joint_speed),
                acceleration,
                jerk: acceleration * ratio,
            },
            envelope,
        )?;
        let valid = S::ZERO < share && share <= S::ONE;
        limits.speed *= share;
        (valid && limits.are_valid()).then_some(limits)
    }
}

fn no_pose(error: PoseError) -> ConstraintViolation {
    ConstraintViolation::Workspace(WorkspaceViolation::Pose(error))
}

fn greater<S: Scalar>([a1, a4]: [S; 2], [b1, b4]: [S; 2]) -> [S; 2] {
    [max(a1, b1.abs()), max(a4, b4.abs())]
}

/// Tightens speed and acceleration until `passing` ṡ² + `starting` |s̈| is within `limit`. Each
/// has half of it, and what the other leaves of its half.
fn share<S: Scalar>(limits: &mut MotionLimits<S>, limit: S, passing: S, starting: S) {
    let half = limit * S::HALF;
    let passed = passing * limits.speed * limits.speed;
    let started = starting * limits.acceleration;
    limits.speed = bounded_by_root(limits.speed, limit - min(half, started), passing);
    limits.acceleration = bounded_by(limits.acceleration, limit - min(half, passed), starting);
}

/// The lesser of `value` and `limit`/`per`, if that is a finite limit.
fn bounded_by<S: Scalar>(value: S, limit: S, per: S) -> S {
    if value * per > limit {
        limit / per
    } else {
        value
    }
}

/// The lesser of `value` and √(`limit`/`per`), if that is a finite limit.
fn bounded_by_root<S: Scalar>(value: S, limit: S, per: S) -> S {
    if value * value * per > limit {
        (limit / per).sqrt()
    } else {
        value
    }
}
