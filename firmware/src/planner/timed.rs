//! Timed moves: pieces of a motion that the host has planned.
//!
//! They pass no look-ahead. Each is checked with its time law and handed to the controller as it
//! is, so the tick follows the host's own motion. The first begins at rest, each one goes on where
//! the last one ended, and every other move must wait until they have come to rest.

use super::segment_feed::ends_in_motion;
use super::{End, MoveError, MoveErrorKind, Planner};
use crate::controller::{ArmController, ExtraTorque, PlanningSnapshot, QueuedSegment};
use crate::drives::Drives;
use crate::motion::{Move, TimedMove};
use crate::safety::Limits;
use fivebar_kinematics::trajectory::{Curve, Reference, TimeLaw, ToolOutput, TrajectorySegment};
use nalgebra::Vector2;
use rtic_core::Mutex;

/// Greatest difference between two pieces, from rounding, in position [m], velocity [m/s] and
/// acceleration [m/s²].
const STEP: [f32; 3] = [2e-6, 2e-3, 1.0];

/// Greatest difference of a tangent's length from 1.
const TANGENT: f32 = 1e-4;

/// Position [m], velocity [m/s] and acceleration [m/s²] of the tool.
pub(super) type ToolMotion = [Vector2<f32>; 3];

/// A timed move's segment, the motion at its end, and θ1, θ4 there [rad] for their turns.
type CheckedTimed = (TrajectorySegment<f32>, ToolMotion, Option<[f32; 2]>);

impl Planner {
    /// Accepts a timed move, as [`Planner::push`] does.
    pub(super) fn push_timed(
        &mut self,
        controller: &mut impl Mutex<T = ArmController<impl Drives>>,
        snapshot: &PlanningSnapshot,
        start: End,
        next: &Move,
        timed: &TimedMove,
    ) -> Result<(), MoveError> {
        let refuse = |kind| MoveError::new(next.tag, kind);
        let output = self.tool_output.output(next.tool, 1.0);
        // The arm rests until the tool has settled.
        let rests = output != self.tool_output.output(self.level, 1.0) && self.tool_output.waits();
        if !self.is_empty() || snapshot.path_free < 1 + usize::from(rests) {
            return Err(refuse(MoveErrorKind::Full));
        }
        let (segment, end, turns) = self.check_timed(next.tag, timed, output, start.turns)?;
        let rest = Vector2::zeros();
        let before = self.in_motion.unwrap_or([start.tool, rest, rest]);
        let begins = tool_motion(&segment.evaluate(0.0)).unwrap_or(before);
        let mut steps = before.iter().zip(&begins).zip(STEP);
        let continues = steps.all(|((before, begins), most)| (begins - before).norm() <= most);
        if !continues || (rests && self.in_motion.is_some()) {
            return Err(refuse(MoveErrorKind::Discontinuous));
        }
        let mut extend = |segment, open| {
            let queued = QueuedSegment {
                segment,
                open,
                limits: Limits::empty(),
                extra: ExtraTorque::ZERO,
            };
            controller.lock(|controller| controller.extend_path(snapshot.path_generation, &queued));
        };
        if rests {
            self.rest_for_tool(next.tool, output, start, next.tag)?;
            if let Some(rest) = self.lookahead.next_segment() {
                extend(rest, false);
            }
        }
        self.level = next.tool;
        let open = ends_in_motion(&segment);
        extend(segment, open);
        self.in_motion = open.then_some(end);
        self.used_before = 0.0;
        self.end = Some(End {
            tool: end[0],
            joints: None,
            turns,
        });
        Ok(())
    }

    /// The segment of a timed move and the motion at its end, if it is within every limit.
    pub(super) fn check_timed(
        &self,
        tag: u32,
        timed: &TimedMove,
        tool: ToolOutput<f32>,
        turns: Option<[f32; 2]>,
    ) -> Result<CheckedTimed, MoveError> {
        let number = MoveError::new(tag, MoveErrorKind::Number);
        let curve = Curve::from(timed.curve);
        if let Curve::Line { tangent, .. } | Curve::Arc { tangent, .. } = curve {
            let unit = (tangent.norm() - 1.0).abs() <= TANGENT;
            if !unit {
                return Err(number);
            }
        }
        let [s, s_dot, s_ddot, jerk] = timed.law;
        let law = TimeLaw::new(s, s_dot, s_ddot, jerk);
        let segment = TrajectorySegment::along(curve, law, timed.duration, tag, tool);
        let (end, turns) = self
            .envelope_of_timed()
            .check_timed_from(&segment, &self.friction, turns)
            .map_err(|error| MoveError::on_path(tag, &error))?;
        Ok((segment, tool_motion(&end).ok_or(number)?, turns))
    }
}

fn tool_motion(reference: &Reference<f32>) -> Option<ToolMotion> {
    match *reference {
        Reference::Tool {
            position,
            velocity,
            acceleration,
        } => Some([position, velocity, acceleration]),
        Reference::Joint { .. } => None,
    }
}
