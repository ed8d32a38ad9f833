//! The path that the tick follows: a queue of trajectory segments and the time along them.
//!
//! Time is a count of ticks from the beginning of a segment, so its error does not grow with the
//! segment's length: a sum of `f32` periods would be minutes off after an hour.
//!
//! The planner hands segments over one by one, and ticks run in between. A path that ends at rest
//! is therefore extended only when the segments behind it are long enough for a stop.

mod brake;
mod output;
mod queue;

use super::time_slices::REACTION;
use crate::safety::Limits;
use crate::settings::Share;
use brake::{Brake, TimeScaling};
use fivebar_kinematics::trajectory::{PathState, Reference, TrajectorySegment};
use queue::PathQueue;

pub(crate) use brake::stopping_time;
pub(crate) use output::{PathOutput, least_rest};
pub(crate) use queue::Change;
pub use queue::QUEUED_SEGMENTS;

/// With this many queued segments or more the planner is not late, even if they are short.
const FEW_SEGMENTS: u32 = QUEUED_SEGMENTS as u32 / 2;

/// A path that ends in motion is committed when it lasts this much longer than a stop [s].
const READY: f32 = 0.02;

/// Segments that one tick may pass; if it should pass more, the path waits for the next tick.
const SEGMENTS_PER_TICK: u32 = 2;

/// A trajectory segment, and what the tick must know about it.
#[derive(Clone, Copy, Debug)]
pub struct QueuedSegment {
    /// The segment.
    pub segment: TrajectorySegment<f32>,
    /// It ends in motion, so another segment must follow in time.
    pub open: bool,
    /// The limits that slow its move below the requested speed.
    pub limits: Limits,
    /// What the motors give besides the torques of the motion.
    pub extra: ExtraTorque,
}

/// Torques that a host adds along a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtraTorque {
    /// At its beginning [N·m].
    pub begin: [f32; 2],
    /// Their change [N·m/s].
    pub rate: [f32; 2],
}

impl ExtraTorque {
    /// None.
    pub const ZERO: Self = Self {
        begin: [0.0; 2],
        rate: [0.0; 2],
    };

    /// So long after the beginning of the segment [s].
    #[inline(always)]
    fn at(&self, time: f32) -> [f32; 2] {
        let ([begin1, begin4], [rate1, rate4]) = (self.begin, self.rate);
        [begin1 + time * rate1, begin4 + time * rate4]
    }
}

/// The queue and the time in its first segment. What every tick needs comes first, see
/// [`Controller`].
///
/// [`Controller`]: super::Controller
#[derive(Clone)]
#[repr(C)]
pub(crate) struct Path {
    /// Ticks in the first segment at full speed.
    ticks: u32,
    /// Time into the first segment before those ticks [s].
    offset: f32,
    /// Committed time left, as of the last tick [s].
    committed_left: f32,
    brake: Option<Brake>,
    /// T [s].
    stopping_time: f32,
    /// Length of path that a stop needs: T/2, two ticks, and the ticks from the fault to the
    /// beginning of the stop [s].
    least: f32,
    /// [s].
    period: f32,
    /// What the motors give besides the torques of the motion [N·m].
    extra: [f32; 2],
    output: PathOutput,
    queue: PathQueue,
}

/// One tick's step along the path.
pub(crate) struct Step<'a> {
    /// The segment that the arm follows.
    pub(crate) segment: &'a TrajectorySegment<f32>,
    /// How far along it.
    path_state: PathState<f32>,
    /// The limits that slow its move below the requested speed.
    pub(crate) limits: Limits,
    /// The arm has come to rest: at the end of the path, or after a stop.
    pub(crate) at_rest: bool,
}

impl Step<'_> {
    /// Where the arm should be.
    #[inline(always)]
    pub(crate) fn reference(&self) -> Reference<f32> {
        self.segment.reference(self.path_state)
    }
}

impl Path {
    /// No path, the tool off; stops will take `stopping_time` [s], ticks `period` [s].
    #[inline(always)]
    pub(crate) fn new(stopping_time: f32, period: f32, output: PathOutput) -> Self {
        Self {
            stopping_time,
            least: 0.5 * stopping_time + (2 + REACTION) as f32 * period,
            period,
            extra: [0.0; 2],
            ticks: 0,
            offset: 0.0,
            committed_left: 0.0,
            brake: None,
            output,
            queue: PathQueue::EMPTY,
        }
    }

    /// Drops all segments, and switches the tool off.
    pub(crate) fn clear(&mut self) {
        self.queue.clear();
        self.drop_committed();
        self.output.clear();
    }

    /// Drops the committed segments.
    pub(crate) fn finish(&mut self) {
        self.drop_committed();
        self.output.end();
    }

    fn drop_committed(&mut self) {
        self.ticks = 0;
        self.offset = 0.0;
        self.committed_left = 0.0;
        self.extra = [0.0; 2];
        self.brake = None;
        self.queue.finish();
    }

    /// What the motors give besides the torques of the motion [N·m].
    #[inline(always)]
    pub(crate) fn extra_torque(&self) -> [f32; 2] {
        self.extra
    }

    /// The output of the tool.
    #[inline(always)]
    pub(crate) fn tool_output(&self) -> Share {
        self.output.now()
    }

    /// Whether the tool is off or up.
    pub(crate) fn tool_is_off(&self) -> bool {
        self.output.is_off()
    }

    /// Switches the tool off. The path is dropped before the arm goes on.
    #[inline(always)]
    pub(crate) fn switch_tool_off(&mut self) {
        self.output.switch_off();
    }

    /// Puts a segment of a crossing into a slot of the empty queue.
    pub(crate) fn store(&mut self, slot: usize, segment: &TrajectorySegment<f32>) {
        self.queue.store(slot, segment);
    }

    /// The segment in a slot.
    #[inline(always)]
    pub(crate) fn stored(&self, slot: usize) -> Option<&TrajectorySegment<f32>> {
        self.queue.stored(slot)
    }

    /// The segments for which the queue has room.
    pub(crate) fn free(&self) -> usize {
        self.queue.free()
    }

    /// Time of all pushed segments that is still ahead, as of the last tick [s].
    pub(crate) fn left(&self) -> f32 {
        self.committed_left + self.queue.uncommitted()
    }

    /// Whether no segment is committed.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    /// Whether the pushed segments end at rest, or fill the queue, or are long enough to begin.
    pub(crate) fn is_enough(&self) -> bool {
        !self.queue.pushed_ends_in_motion()
            || self.queue.is_full()
            || self.left() >= self.least + READY
    }

    /// Whether the planner is late: the path ends in motion, a stop needs all that is left of it,
    /// and few segments are queued. (Many segments can be as short in time while the planner
    /// keeps the queue full.)
    #[inline(always)]
    pub(crate) fn runs_short(&self) -> bool {
        // The first comparison decides in nearly every tick.
        self.committed_left < self.least
            && self.queue.ends_in_motion()
            && self.brake.is_none()
            && self.queue.len() < FEW_SEGMENTS
    }

    /// Tag of the segment in progress.
    pub(crate) fn tag(&self) -> Option<u32> {
        self.queue.first().map(|first| first.queued.segment.tag())
    }

    /// Appends a segment; drops it if the queue is full.
    pub(crate) fn push(&mut self, queued: &QueuedSegment) {
        if self.queue.is_full() {
            return;
        }
        let changes_tool = self.output.push(queued.segment.tool_output());
        self.queue.push(queued, changes_tool);
        // The committed path already ends in motion, so commit any extension at once.
        if self.queue.ends_in_motion() || self.is_enough() {
            self.commit();
        }
    }

    /// Number of segments ever pushed, modulo 2³².
    pub(crate) fn pushed(&self) -> u32 {
        self.queue.pushed()
    }

    /// Stores the n-th segment ever behind the committed ones, which begins so long after the last one of these does [s].
    pub(crate) fn store_behind(&mut self, n: u32, queued: &QueuedSegment, after: f32) {
        self.queue.store_behind(n, queued, after);
    }

    /// Changes the last committed segment, which is the `last` one ever, and commits what was stored behind it up to the n-th
    /// one, which ends at rest. Returns whether it has: not in a stop, nor where it would change the segment in progress for another.
    pub(crate) fn splice(&mut self, last: u32, change: Change<'_>, n: u32) -> bool {
        let least = match change {
            Change::EndAfter(_) => 1,
            Change::Replace(_) => 2,
        };
        if self.brake.is_some() || !self.queue.ends_with(last, least) {
            return false;
        }
        self.committed_left += self.queue.splice(change, n);
        true
    }

    fn commit(&mut self) {
        let begins = self.queue.is_empty();
        self.committed_left += self.queue.commit();
        if let (true, Some(first)) = (begins, self.queue.first()) {
            self.committed_left += first.queued.segment.duration();
            let output = first.queued.segment.tool_output();
            self.output.begin(output, first.changes_tool);
        }
    }

    /// Begins a stop, with the tool off. It is shorter than T where a path that ends in motion is
    /// too short for T.
    #[cold]
    pub(crate) fn brake(&mut self) {
        self.output.switch_off();
        self.extra = [0.0; 2];
        if self.brake.is_none() {
            let mut time = self.stopping_time;
            if self.queue.ends_in_motion() {
                let tick = self.period;
                let most = 2.0 * (self.committed_left - tick - tick);
                if most < time {
                    time = most;
                }
                if time < tick + tick {
                    time = tick + tick;
                }
            }
            self.brake = Some(Brake::new(time));
        }
    }

    /// Advances by one tick; `None` where there is no path.
    #[inline(always)]
    pub(crate) fn step(&mut self) -> Option<Step<'_>> {
        // Each case by itself: a tick that brakes does not do the work of one at full speed.
        let (path_state, at_rest) = if let Some(brake) = &mut self.brake {
            let TimeScaling {
                advance,
                sigma,
                sigma_dot,
                complete,
            } = brake.step(self.period);
            let (time, ended) = self.pass(Some(advance))?;
            let segment = &self.queue.first()?.queued.segment;
            // Nobody asks for the time left of a path that will be dropped, and the tool is off.
            let path_state = segment.path_state(time).time_scaled(sigma, sigma_dot);
            (at_rest(path_state, ended), ended || complete)
        } else {
            self.ticks = self.ticks.wrapping_add(1);
            let (time, ended) = self.pass(None)?;
            let first = self.queue.first()?;
            let segment = &first.queued.segment;
            self.committed_left = segment.duration() - time + self.queue.behind(first);
            let path_state = segment.path_state(time);
            // The host's torques wait for some ticks where the tool's output changes: a tick does one of both.
            if self.output.is_busy() {
                self.output.step(segment.tool_output(), path_state.s_dot);
            } else {
                self.extra = first.queued.extra.at(time);
            }
            (at_rest(path_state, ended), ended)
        };
        let queued = &self.queue.first()?.queued;
        Some(Step {
            at_rest,
            segment: &queued.segment,
            path_state,
            limits: queued.limits,
        })
    }

    /// Passes the segments that this tick ends, at most [`SEGMENTS_PER_TICK`]; `advance` [s] is the
    /// time since a stop began. Returns the time [s] into the first segment, and whether the path
    /// has ended there.
    #[inline(always)]
    fn pass(&mut self, advance: Option<f32>) -> Option<(f32, bool)> {
        let mut duration = self.queue.first()?.queued.segment.duration();
        let mut time = self.offset + self.period * self.ticks as f32;
        if let Some(advance) = advance {
            time += advance;
        }
        let (mut ended, mut changes_tool) = (false, false);
        if time >= duration {
            for _ in 0..SEGMENTS_PER_TICK {
                if self.queue.is_last() {
                    ended = true;
                    break;
                }
                time -= duration;
                self.queue.pass();
                let first = self.queue.first()?;
                changes_tool |= first.changes_tool;
                duration = first.queued.segment.duration();
                if time < duration {
                    break;
                }
            }
            if time > duration {
                // The path has ended, or waits for the next tick.
                time = duration;
            }
            // After the beginning of a stop the tool stays off.
            if changes_tool && advance.is_none() {
                self.output.wake();
            }
            self.ticks = 0;
            self.offset = advance.map_or(time, |advance| time - advance);
        }
        Some((time, ended))
    }
}

/// At the end of a path, its last place at rest.
#[inline(always)]
fn at_rest(path_state: PathState<f32>, ended: bool) -> PathState<f32> {
    if !ended {
        return path_state;
    }
    PathState {
        s: path_state.s,
        s_dot: 0.0,
        s_ddot: 0.0,
    }
}

#[cfg(test)]
mod tests;
