//! A piece of a stream's motion, checked together with its stop.

use super::{StreamEnd, StreamMode, StreamPoint, StreamReason};
use crate::planner::check::near;
use crate::planner::{MoveErrorKind, Planner};
use fivebar_kinematics::five_bar::PoseError;
use fivebar_kinematics::trajectory::{
    ConstraintViolation, Envelope, StopStart, ToolMotion, TrajectorySegment,
};
use fivebar_kinematics::{PlanarVector, Scalar};
use nalgebra::Vector2;

/// The shortest stop [ticks].
const LEAST_STOP: u32 = 4;
/// The shortest one in times of that in which the last velocity is nearly kept: it has 95 % of it then.
const STOP_IN_COASTS: u32 = 4;
/// The greatest difference between a point's angle and that of the arm there, from rounding [rad].
const SAME_TURN: f32 = 1e-3;

/// A checked piece.
pub(super) struct Piece {
    pub(super) motion: TrajectorySegment<f32>,
    /// What follows if no other piece does.
    pub(super) stop: TrajectorySegment<f32>,
    /// Its duration.
    pub(super) ticks: u32,
    /// The tool at its end.
    pub(super) tool: ToolMotion<f32>,
    /// θ1, θ4 there [rad].
    pub(super) angles: [f32; 2],
    /// What the host adds to the torques there [N·m].
    pub(super) torque: [f32; 2],
}

impl Planner {
    /// The piece from the end of the last one to a point, so many ticks later.
    ///
    /// # Errors
    /// The limit that the piece or its stop would pass.
    pub(super) fn piece(
        &self,
        from: &StreamEnd,
        mode: StreamMode,
        point: &StreamPoint,
        ticks: u32,
        n: u16,
    ) -> Result<Piece, StreamReason> {
        let tool = match mode {
            StreamMode::Tip | StreamMode::Free | StreamMode::Impedance(_) => ToolMotion {
                position: Vector2::new(point.position.0, point.position.1),
                velocity: Vector2::new(point.velocity.0, point.velocity.1),
            },
            StreamMode::Joint => self.tool_motion(point.position.into(), point.velocity.into())?,
        };
        let period = 1.0 / self.tick_rate;
        let output = self.tool_output.output(self.level, 1.0);
        let duration = period * ticks as f32;
        let motion = TrajectorySegment::between(&from.tool, &tool, duration, n.into(), output);
        let torque = self.added_torque(mode, point, &tool)?;
        let envelope = self.envelope_beside(from.torque, torque);
        envelope
            .check_timed_from(&motion, &self.friction, Some(from.angles))
            .map_err(|error| limit(error.violation))?;
        let (angles, rates) = self.joint_motion(&tool, from.angles)?;
        if mode == StreamMode::Joint {
            // A whole turn away is another place of a joint, and no other one of the tool.
            for (joint, (angle, wanted)) in [1, 4]
                .into_iter()
                .zip(angles.into_iter().zip(<[f32; 2]>::from(point.position)))
            {
                if Scalar::abs(angle - wanted) > SAME_TURN {
                    return Err(StreamReason::Limit(MoveErrorKind::JointLimit(joint)));
                }
            }
        }
        let least = LEAST_STOP.max(STOP_IN_COASTS * self.coast());
        let start = StopStart {
            tool,
            angles,
            rates,
            least: period * least as f32,
        };
        let stop = envelope
            .plan_stop(&start, &self.friction, n.into(), output)
            .map_err(limit)?;
        Ok(Piece {
            motion,
            stop,
            ticks,
            tool,
            angles,
            torque,
        })
    }

    /// What a point adds to the torques of the joints [N·m]: τ = Jᵀ f of a force f on the tool [N].
    fn added_torque(
        &self,
        mode: StreamMode,
        point: &StreamPoint,
        tool: &ToolMotion<f32>,
    ) -> Result<[f32; 2], StreamReason> {
        let (first, second) = point.force;
        if mode == StreamMode::Joint || point.force == (0.0, 0.0) {
            return Ok([first, second]);
        }
        let workspace = &self.envelope.workspace;
        let pose = workspace.tool.inverse(tool.position, workspace.mode);
        let jacobian = workspace.tool.jacobian(&pose.map_err(no_pose)?);
        Ok(jacobian
            .map_err(no_pose)?
            .torques(Vector2::new(first, second)))
    }

    /// The limits of a motion during which the host's torques pass from the first to the second [N·m]: they leave less for it.
    fn envelope_beside(&self, [begin1, begin4]: [f32; 2], [end1, end4]: [f32; 2]) -> Envelope<f32> {
        let mut envelope = self.envelope_of_timed();
        if let Some(limits) = &mut envelope.torque {
            let [torque1, torque4] = limits.torque;
            let most = |begin: f32, end: f32| Scalar::abs(begin).max(Scalar::abs(end));
            limits.torque = [torque1 - most(begin1, end1), torque4 - most(begin4, end4)];
        }
        envelope
    }

    /// θ1, θ4 [rad], each in the turn in which it is nearest to another angle, and ω1, ω4 [rad/s] where the tool moves so.
    pub(super) fn joint_motion(
        &self,
        tool: &ToolMotion<f32>,
        [near1, near4]: [f32; 2],
    ) -> Result<([f32; 2], [f32; 2]), StreamReason> {
        let workspace = &self.envelope.workspace;
        let pose = workspace.tool.inverse(tool.position, workspace.mode);
        let pose = pose.map_err(no_pose)?;
        let velocities = workspace.tool.inverse_velocities(&pose, tool.velocity);
        let [omega1, _, _, omega4] = velocities.map_err(no_pose)?.omega;
        let angles = [
            near(pose.u1.polar_angle(), near1),
            near(pose.u4.polar_angle(), near4),
        ];
        Ok((angles, [omega1, omega4]))
    }

    /// The tool where the joints have these angles [rad] and velocities [rad/s], in the arm's working mode.
    pub(super) fn tool_motion(
        &self,
        [theta1, theta4]: [f32; 2],
        [omega1, omega4]: [f32; 2],
    ) -> Result<ToolMotion<f32>, StreamReason> {
        let workspace = &self.envelope.workspace;
        let tool = &workspace.tool;
        let geometry = tool.geometry();
        let pose = geometry
            .forward(theta1, theta4, self.assembly)
            .map_err(no_pose)?;
        let (mode, own) = (tool.working_mode(&pose), workspace.mode);
        for (leg, same) in [
            (1, mode.elbow1 == own.elbow1),
            (4, mode.elbow4 == own.elbow4),
        ] {
            if !same {
                return Err(StreamReason::Limit(MoveErrorKind::LegSingularity(leg)));
            }
        }
        let velocities = geometry
            .forward_velocities(&pose, omega1, omega4)
            .map_err(no_pose)?;
        Ok(ToolMotion {
            position: tool.point(&pose),
            velocity: tool.velocity(&pose, &velocities),
        })
    }
}

fn limit(violation: ConstraintViolation) -> StreamReason {
    StreamReason::Limit(violation.into())
}

fn no_pose(error: PoseError) -> StreamReason {
    limit(error.into())
}
