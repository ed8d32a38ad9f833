//! The pieces of a crossing, which the tick follows: polynomials of the joints' angles and torques.

use super::Planner;
use super::crossing::Gap;
use crate::controller::{CROSSING_PIECES, crossing_polynomials};
use crate::motion::CrossingMove;
use fivebar_kinematics::five_bar::{Accelerations, Pose, PoseError, Velocities};
use fivebar_kinematics::trajectory::TrajectorySegment;
use nalgebra::Vector2;

/// Angles [rad], and their change and its change in the time of a piece.
type JointState = [Vector2<f32>; 3];

/// The arm at one time of a plan.
pub(super) struct ArmOn {
    pub(super) pose: Pose<f32>,
    pub(super) velocities: Velocities<f32>,
    pub(super) accelerations: Accelerations<f32>,
}

impl Planner {
    /// The polynomials of the joints' angles [rad] and of their torques without friction [N·m] on a piece
    /// of a plan that was checked: the joints by angles, speeds and accelerations at both its ends, the
    /// torques by four of their values. None where the arm has no pose.
    pub(super) fn crossing_piece(
        &self,
        plan: &CrossingMove,
        gap: &Gap,
        piece: usize,
    ) -> Option<[TrajectorySegment<f32>; 2]> {
        let time = plan.duration / CROSSING_PIECES as f32;
        let start = time * piece as f32;
        let [p, v, a] = self.joints_on(plan, start, time)?;
        let [q, w, b] = self.joints_on(plan, start + time, time)?;
        let displacement = q - p;
        let joints = [
            p,
            v,
            a * 0.5,
            displacement * 10.0 - v * 6.0 - w * 4.0 - a * 1.5 + b * 0.5,
            displacement * -15.0 + v * 8.0 + w * 7.0 + a * 1.5 - b,
            displacement * 6.0 - (v + w) * 3.0 - (a - b) * 0.5,
        ];
        let [[t0, t1], [t2, t3]] = [[0.0, 1.0], [2.0, 3.0]].map(|pair: [f32; 2]| {
            pair.map(|k| self.crossing_torque(plan, gap, start + time * (k / 3.0)))
        });
        let (t0, t1, t2, t3) = (t0?, t1?, t2?, t3?);
        let torques = [
            t0,
            t1 * 9.0 - t0 * 5.5 - t2 * 4.5 + t3,
            t0 * 9.0 - t1 * 22.5 + t2 * 18.0 - t3 * 4.5,
            (t1 - t2) * 13.5 + (t3 - t0) * 4.5,
            Vector2::zeros(),
            Vector2::zeros(),
        ];
        Some([joints, torques].map(|pairs| crossing_polynomials(pairs.map(Into::into))))
    }

    /// The torques without friction at a time [N·m].
    fn crossing_torque(&self, plan: &CrossingMove, gap: &Gap, time: f32) -> Option<Vector2<f32>> {
        let [begin, end] = gap.time;
        if begin <= time && time <= end {
            return Some(gap.torque_at(time));
        }
        let arm = self.arm_on(plan, time).ok()?;
        self.torque_of(&arm).ok()
    }

    /// The driven joints at a time [s]; changes are in the time `unit` [s].
    fn joints_on(&self, plan: &CrossingMove, time: f32, unit: f32) -> Option<JointState> {
        let ArmOn {
            pose,
            velocities,
            accelerations,
        } = self.arm_on(plan, time).ok()?;
        let ([w1, _, _, w4], [a1, _, _, a4]) = (velocities.omega, accelerations.alpha);
        let [theta1, _, _, theta4] = pose.angles();
        let limits = self.envelope.workspace.limits?;
        let angles = limits.angles_within(theta1, theta4).ok()?;
        Some([
            Vector2::from(angles),
            Vector2::new(w1, w4) * unit,
            Vector2::new(a1, a4) * (unit * unit),
        ])
    }

    /// The arm at a time [s] of a plan.
    // Called in some places, not time-critical: not inlined, to save flash.
    #[inline(never)]
    pub(super) fn arm_on(&self, plan: &CrossingMove, time: f32) -> Result<ArmOn, PoseError> {
        let [position, velocity, acceleration] = plan.motion(time);
        let workspace = &self.envelope.workspace;
        let tool = &workspace.tool;
        let pose = tool.inverse(position, workspace.mode)?;
        let velocities = tool.inverse_velocities(&pose, velocity)?;
        let accelerations = tool.inverse_accelerations(&pose, &velocities, acceleration)?;
        Ok(ArmOn {
            pose,
            velocities,
            accelerations,
        })
    }

    /// The torques of a motion without friction [N·m].
    #[inline(never)]
    pub(super) fn torque_of(&self, arm: &ArmOn) -> Result<Vector2<f32>, PoseError> {
        let Some(limits) = &self.envelope.torque else {
            return Ok(Vector2::zeros());
        };
        let none = Vector2::zeros();
        let torque =
            limits
                .arm
                .inverse_dynamics(&arm.pose, &arm.velocities, &arm.accelerations, none)?;
        Ok(torque.into())
    }
}
