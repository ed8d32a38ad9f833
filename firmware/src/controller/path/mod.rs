//! The segments of path that the tick follows, and the clock by which it does.
//!
//! The clock counts ticks from the beginning of a segment, so that it stays true however long
//! the segment: a sum of `f32` periods would lose minutes in an hour.
//!
//! Segments come one by one, and ticks come between them. So a path that ends at rest goes on
//! only when what follows is enough to stop on, however long planning it takes.

mod brake;
mod queue;

use crate::safety::Limits;
use brake::{Brake, TimeScaling};
use fivebar_kinematics::trajectory::{Reference, TrajectorySegment};
use queue::PathQueue;

pub(crate) use brake::stopping_time;
pub use queue::QUEUED_SEGMENTS;

/// With so many segments to come or more, the planner is not behind, however short they are.
const FEW_SEGMENTS: u32 = QUEUED_SEGMENTS as u32 / 2;

/// A path that breaks off in motion is committed with so much in hand beyond a stop [s].
const READY: f32 = 0.02;

/// Segments that one tick may leave behind; more make the path wait for the next tick.
const SEGMENTS_PER_TICK: u32 = 2;

/// A segment of path and what the tick must know about it.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// The segment.
    pub segment: TrajectorySegment<f32>,
    /// It ends in motion: another must follow in time.
    pub open: bool,
    /// The limits for which its move goes slower than was asked for.
    pub limits: Limits,
}

/// The queue and the place in it; what every tick needs in front, see [`Controller`].
///
/// [`Controller`]: super::Controller
#[repr(C)]
pub(crate) struct Path {
    /// Ticks at full rate in the first segment.
    ticks: u32,
    /// Time into the first segment before those ticks [s].
    offset: f32,
    /// Committed time left, as of the last tick [s].
    committed_left: f32,
    brake: Option<Brake>,
    /// T [s].
    stopping_time: f32,
    /// What a stop takes of the path, T/2 and two ticks [s].
    least: f32,
    /// [s].
    period: f32,
    queue: PathQueue,
}

/// One tick's step along the path.
pub(crate) struct Step {
    /// Where the arm should be.
    pub(crate) reference: Reference<f32>,
    /// The limits for which its move goes slower than was asked for.
    pub(crate) limits: Limits,
    /// The arm has come to rest, at the path's end or braked.
    pub(crate) at_rest: bool,
}

impl Path {
    /// No path; stops will take `stopping_time` [s], ticks `period` [s].
    pub(crate) fn new(stopping_time: f32, period: f32) -> Self {
        Self {
            stopping_time,
            least: 0.5 * stopping_time + 2.0 * period,
            period,
            ticks: 0,
            offset: 0.0,
            committed_left: 0.0,
            brake: None,
            queue: PathQueue::new(),
        }
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.queue.clear();
        self.finish();
    }

    /// Leaves all behind that was committed.
    pub(crate) fn finish(&mut self) {
        self.ticks = 0;
        self.offset = 0.0;
        self.committed_left = 0.0;
        self.brake = None;
        self.queue.finish();
    }

    /// Whether there is no room for another segment.
    pub(crate) fn is_full(&self) -> bool {
        self.queue.is_full()
    }

    /// What is left of all that was pushed, as of the last tick [s].
    pub(crate) fn left(&self) -> f32 {
        self.committed_left + self.queue.uncommitted()
    }

    /// Whether there is nothing to follow.
    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    /// Whether all that was pushed ends at rest, fills the queue, or is enough to begin with.
    pub(crate) fn is_enough(&self) -> bool {
        !self.queue.pushed_ends_in_motion()
            || self.queue.is_full()
            || self.left() >= self.least + READY
    }

    /// Whether the path breaks off in motion, and all that is left of it is needed to stop
    /// on, in few segments: the planner is behind. A queue of many segments can be as short while
    /// the planner keeps it full.
    #[inline(always)]
    pub(crate) fn runs_short(&self) -> bool {
        // The first comparison is the one that mostly decides.
        self.committed_left < self.least
            && self.queue.ends_in_motion()
            && self.brake.is_none()
            && self.queue.len() < FEW_SEGMENTS
    }

    /// Tag of the segment in progress.
    pub(crate) fn tag(&self) -> Option<u32> {
        self.queue.first().map(|first| first.stretch.segment.tag())
    }

    /// Appends a stretch, unless the queue is full.
    pub(crate) fn push(&mut self, stretch: Stretch) {
        if self.queue.push(stretch).is_err() {
            return;
        }
        // The committed path already ends in motion, so commit any extension at once.
        if self.queue.ends_in_motion() || self.is_enough() {
            self.commit();
        }
    }

    fn commit(&mut self) {
        let begins = self.queue.is_empty();
        self.committed_left += self.queue.commit();
        if let (true, Some(first)) = (begins, self.queue.first()) {
            self.committed_left += first.stretch.segment.duration();
        }
    }

    /// Begins to come to rest; sooner than usual where a path that breaks off leaves no
    /// room for that.
    #[cold]
    pub(crate) fn brake(&mut self) {
        if self.brake.is_none() {
            let mut time = self.stopping_time;
            if self.committed_left < self.least && self.queue.ends_in_motion() {
                let tick = self.period;
                time = 2.0 * (self.committed_left - tick - tick);
                if time < tick + tick {
                    time = tick + tick;
                }
            }
            self.brake = Some(Brake::new(time));
        }
    }

    /// One tick along the path; `None` where there is none.
    #[inline(always)]
    pub(crate) fn step(&mut self) -> Option<Step> {
        let mut first = self.queue.first()?;
        let scaling = match &mut self.brake {
            None => {
                self.ticks = self.ticks.wrapping_add(1);
                None
            }
            Some(brake) => Some(brake.step(self.period)),
        };
        let advance = scaling.as_ref().map_or(0.0, |scaling| scaling.advance);
        let mut time = self.offset + self.period * self.ticks as f32 + advance;
        let mut duration = first.stretch.segment.duration();
        let mut ended = false;
        if time >= duration {
            for _ in 0..SEGMENTS_PER_TICK {
                if self.queue.is_last() {
                    ended = true;
                    break;
                }
                time -= duration;
                self.queue.pass();
                first = self.queue.first()?;
                duration = first.stretch.segment.duration();
                if time < duration {
                    break;
                }
            }
            if time > duration {
                // The path has ended, or waits.
                time = duration;
            }
            self.ticks = 0;
            self.offset = time - advance;
        }
        self.committed_left = duration - time + self.queue.behind(first);
        let mut path_state = first.stretch.segment.path_state(time);
        if let Some(TimeScaling {
            sigma, sigma_dot, ..
        }) = scaling
        {
            path_state = path_state.time_scaled(sigma, sigma_dot);
        }
        Some(Step {
            at_rest: ended || scaling.is_some_and(|scaling| scaling.stands),
            reference: first.stretch.segment.reference(path_state),
            limits: first.stretch.limits,
        })
    }
}

#[cfg(test)]
mod tests;
