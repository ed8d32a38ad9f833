//! The controller's interface to a stream of set-points: the path that the planner extends before its end, and what the host
//! is told meanwhile.

use super::path::Change;
use super::{ArmController, QUEUED_SEGMENTS, QueuedSegment};
use crate::drives::{Drives, Needs};
use crate::safety::{Fault, State};

/// How a path goes on in place of its stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Splice<'a> {
    /// The tick in which it does.
    pub(crate) begins: u32,
    /// The number of segments ever pushed, with the last committed one.
    pub(crate) last: u32,
    /// What becomes of that.
    pub(crate) change: Change<'a>,
    /// The number with the segments that were stored behind it.
    pub(crate) commits: u32,
}

/// The joints, as a host is told of them. Pairs are of joint 1 and joint 4.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StreamSample {
    /// Ticks since the reset.
    pub(crate) tick: u32,
    /// θ̂ [rad].
    pub(crate) angle: [f32; 2],
    /// ω̂ [rad/s].
    pub(crate) velocity: [f32; 2],
    /// Demanded [N·m].
    pub(crate) torque: [f32; 2],
}

impl<D: Drives> ArmController<D> {
    /// Whether the arm is held, awake, with free brakes and without a path, also one that has not begun.
    pub(crate) fn lets_stream(&self) -> bool {
        self.state == State::Armed
            && self.waking == 0
            && self.path.free() == QUEUED_SEGMENTS
            && self.brake.lets_move()
    }

    /// Whether the motors give torques: those of steppers and servos follow a motion.
    pub(crate) fn gives_torque(&self) -> bool {
        D::NEEDS == Needs::Torque
    }

    /// Begins a path with a rest. Returns the tick of its beginning and the number of segments ever pushed; none if the arm is
    /// not at rest and free.
    pub(crate) fn begin_stream_path(
        &mut self,
        path_generation: u32,
        rest: &QueuedSegment,
    ) -> Option<[u32; 2]> {
        if !self.lets_stream() || path_generation != self.path_generation {
            return None;
        }
        self.path.push(rest);
        // The next tick begins it.
        Some([self.ticks.wrapping_add(1), self.path.pushed()])
    }

    /// Stores a segment for a splice, so that this only has to change one: the tick waits for no more than a segment's copy. It
    /// begins so long after the last committed one does [s].
    pub(crate) fn store_for_splice(&mut self, n: u32, queued: &QueuedSegment, after: f32) {
        self.path.store_behind(n, queued, after);
    }

    /// Goes on in another way than by the stop. Returns whether it does: not if that begins too soon, or the path was dropped
    /// or is being stopped.
    pub(crate) fn splice_path(&mut self, path_generation: u32, splice: &Splice<'_>) -> bool {
        let ahead = splice.begins.wrapping_sub(self.ticks) as i32;
        self.state.follows_paths()
            && ahead > 0
            && path_generation == self.path_generation
            && self.path.splice(splice.last, splice.change, splice.commits)
    }

    /// Latches the fault of a silent host while an arm is held whose host streams set-points. Along a path the tick does.
    pub(crate) fn latch_silence(&mut self) {
        if self.state == State::Armed && self.host_timed_out() {
            self.latch_fault(Fault::CommandTimeout);
        }
    }

    /// What the host of a stream is told.
    pub(crate) fn stream_sample(&self) -> StreamSample {
        StreamSample {
            tick: self.ticks,
            angle: self.angles(),
            velocity: self.velocities(),
            torque: self.torques(),
        }
    }
}
