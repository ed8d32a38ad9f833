//! How the planner hands trajectory segments to the controller: as many as a stop needs.

use super::Planner;
use crate::controller::{ArmController, ExtraTorque, QUEUED_SEGMENTS, QueuedSegment};
use crate::drives::Drives;
use crate::safety::{Limits, State};
use fivebar_kinematics::Scalar;
use fivebar_kinematics::trajectory::{Reference, TrajectorySegment};
use rtic_core::Mutex;

/// Segments that one run hands out, unless they end in motion too near the path's end for a stop.
pub const SEGMENTS_PER_RUN: u32 = 4;

impl Planner {
    /// Hands the controller as much path as it should have. To be called at least every few
    /// milliseconds while the arm moves. While the arm crosses a singularity, it looks in which assembly mode it
    /// is behind it, and ends the crossing. The controller is unlocked while a segment is planned.
    pub fn run(&mut self, controller: &mut impl Mutex<T = ArmController<impl Drives>>) {
        let mut snapshot = controller.lock(|controller| controller.planning_snapshot());
        self.watch_stream(controller, &snapshot);
        if snapshot.state == State::Crossing {
            return self.judge_crossing(controller);
        }
        self.append_waiting_in_time();
        for handed in 0..QUEUED_SEGMENTS as u32 {
            self.follow(&snapshot);
            let ahead = handed >= SEGMENTS_PER_RUN || snapshot.path_left >= self.horizon;
            // A path that is not enough does not begin, however long it is.
            if ahead && snapshot.path_is_enough || snapshot.path_free == 0 {
                break;
            }
            // A plan takes up to some milliseconds: too long where a stop soon needs all that is left.
            let in_haste = snapshot.state == State::Running && !snapshot.path_is_enough;
            let next = match in_haste {
                true => self.lookahead.next_segment_in_haste(),
                false => self.lookahead.next_segment(),
            };
            let Some(segment) = next else {
                break;
            };
            let slowed = self
                .slowed
                .oldest_ordered()
                .any(|&tag| tag == segment.tag());
            let queued = QueuedSegment {
                segment,
                open: ends_in_motion(&segment),
                limits: Limits::empty().with(Limits::SPEED, slowed),
                extra: ExtraTorque::ZERO,
            };
            let generation = self.path_generation;
            controller.lock(|controller| controller.extend_path(generation, &queued));
            snapshot = controller.lock(|controller| controller.planning_snapshot());
        }
    }
}

/// Whether another segment must follow this one: its speed at the end is more than rounding.
pub(super) fn ends_in_motion(segment: &TrajectorySegment<f32>) -> bool {
    match segment.evaluate(segment.duration()) {
        Reference::Tool { velocity, .. } => velocity.norm_squared() > 1e-6,
        Reference::Joint { rates, .. } => rates.iter().any(|&rate| Scalar::abs(rate) > 1e-2),
    }
}
