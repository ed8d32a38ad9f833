//! The queue of trajectory segments that the tick follows, and the time that they take.
//!
//! Each segment holds the time of its end: the sum of all durations that were pushed, in whole
//! microseconds, wrapping. The time behind a segment is then the difference of two such ends, and
//! rounding does not accumulate, however many segments were passed.
//!
//! The tick does not see a pushed segment before it is committed.

use super::{ExtraTorque, QueuedSegment};
use crate::safety::Limits;
use fivebar_kinematics::trajectory::TrajectorySegment;

/// Room for segments in the queue.
pub const QUEUED_SEGMENTS: usize = 32;

/// The longest time that a segment counts for [µs]. No caller distinguishes longer times, and
/// the sum of a full queue stays far from overflow.
const LONGEST: u32 = 60_000_000;

/// A queued segment and the time of its end.
#[derive(Clone, Copy)]
pub(super) struct Timed {
    pub(super) queued: QueuedSegment,
    /// Its tool output differs from that of the segment before, or follows the speed.
    pub(super) changes_tool: bool,
    /// [µs].
    end: u32,
}

/// What becomes of the last committed segment.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Change<'a> {
    /// It ends after this time [s].
    EndAfter(f32),
    /// Another one takes its place.
    Replace(&'a QueuedSegment),
}

/// The end of the committed or of the pushed path.
#[derive(Clone, Copy)]
struct Extent {
    /// Segments so far, with those passed; wraps, and `QUEUED_SEGMENTS` divides its range.
    count: u32,
    /// Time at which the last one ends [µs].
    end: u32,
    /// The last one ends in motion.
    in_motion: bool,
}

/// The queue, a ring buffer. What every tick needs comes first, see [`Controller`].
///
/// [`Controller`]: crate::Controller
#[derive(Clone)]
#[repr(C)]
pub(super) struct PathQueue {
    /// Number of segments passed so far.
    passed: u32,
    committed: Extent,
    pushed: Extent,
    slots: [Timed; QUEUED_SEGMENTS],
}

impl PathQueue {
    /// No segments. A constant: it is written into its place, without the stack of another queue.
    pub(super) const EMPTY: Self = {
        let nothing = QueuedSegment {
            segment: TrajectorySegment::NONE,
            open: false,
            limits: Limits::empty(),
            extra: ExtraTorque::ZERO,
        };
        let start = Extent {
            count: 0,
            end: 0,
            in_motion: false,
        };
        Self {
            passed: 0,
            committed: start,
            pushed: start,
            slots: [Timed {
                queued: nothing,
                changes_tool: false,
                end: 0,
            }; QUEUED_SEGMENTS],
        }
    };

    /// Drops all segments.
    pub(super) fn clear(&mut self) {
        self.committed = self.pushed;
        self.finish();
    }

    /// Passes all committed segments.
    pub(super) fn finish(&mut self) {
        self.passed = self.committed.count;
        self.committed.in_motion = false;
    }

    /// Puts a segment of a crossing into a slot of an empty queue.
    pub(super) fn store(&mut self, slot: usize, segment: &TrajectorySegment<f32>) {
        if let Some(free) = self.slots.get_mut(slot) {
            free.queued.segment.copy_from(segment);
        }
    }

    /// The segment in a slot.
    #[inline(always)]
    pub(super) fn stored(&self, slot: usize) -> Option<&TrajectorySegment<f32>> {
        Some(&self.slots.get(slot)?.queued.segment)
    }

    /// Whether no segment is committed.
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.passed == self.committed.count
    }

    /// Number of committed segments, with the first one.
    #[inline(always)]
    pub(super) fn len(&self) -> u32 {
        self.committed.count.wrapping_sub(self.passed)
    }

    /// Whether there is no room for another segment, committed or not.
    pub(super) fn is_full(&self) -> bool {
        self.pushed.count.wrapping_sub(self.passed) == QUEUED_SEGMENTS as u32
    }

    /// The segments for which there is room.
    pub(super) fn free(&self) -> usize {
        QUEUED_SEGMENTS.saturating_sub(self.pushed.count.wrapping_sub(self.passed) as usize)
    }

    /// Whether exactly one segment is committed.
    #[inline(always)]
    pub(super) fn is_last(&self) -> bool {
        self.passed.wrapping_add(1) == self.committed.count
    }

    /// Whether the committed path ends in motion.
    #[inline(always)]
    pub(super) fn ends_in_motion(&self) -> bool {
        self.committed.in_motion
    }

    /// Whether the pushed path ends in motion.
    pub(super) fn pushed_ends_in_motion(&self) -> bool {
        self.pushed.in_motion
    }

    /// The segment in progress.
    #[inline(always)]
    pub(super) fn first(&self) -> Option<&Timed> {
        if self.is_empty() {
            return None;
        }
        self.slots.get(slot(self.passed))
    }

    /// Passes the first segment, unless it is the last committed one.
    #[inline(always)]
    pub(super) fn pass(&mut self) {
        if !self.is_empty() && !self.is_last() {
            self.passed = self.passed.wrapping_add(1);
        }
    }

    /// Appends a segment; the caller has checked that there is room.
    pub(super) fn push(&mut self, queued: &QueuedSegment, changes_tool: bool) {
        let Some(slot) = self.slots.get_mut(slot(self.pushed.count)) else {
            return;
        };
        let duration = microseconds(queued.segment.duration());
        self.pushed = Extent {
            count: self.pushed.count.wrapping_add(1),
            end: self.pushed.end.wrapping_add(duration),
            in_motion: queued.open,
        };
        slot.queued.segment.copy_from(&queued.segment);
        slot.queued.open = queued.open;
        slot.queued.limits = queued.limits;
        slot.queued.extra = queued.extra;
        slot.changes_tool = changes_tool;
        slot.end = self.pushed.end;
    }

    /// Number of segments ever pushed; wraps.
    pub(super) fn pushed(&self) -> u32 {
        self.pushed.count
    }

    /// Whether the n-th segment ever is the last committed one, with so many at least before it that are not passed, itself
    /// among them.
    pub(super) fn ends_with(&self, n: u32, least: u32) -> bool {
        n == self.committed.count && self.len() >= least
    }

    /// Stores the n-th segment ever behind the committed ones, if there is room. It begins so long after the last committed one
    /// does [s].
    pub(super) fn store_behind(&mut self, n: u32, queued: &QueuedSegment, after: f32) {
        let is_free = n.wrapping_sub(self.passed) <= QUEUED_SEGMENTS as u32;
        let begins = self.last_begins().wrapping_add(microseconds(after));
        if let (true, Some(slot)) = (is_free, self.slots.get_mut(slot(n.wrapping_sub(1)))) {
            slot.queued.segment.copy_from(&queued.segment);
            slot.queued.open = queued.open;
            slot.queued.limits = queued.limits;
            slot.queued.extra = queued.extra;
            slot.changes_tool = false;
            slot.end = begins.wrapping_add(microseconds(queued.segment.duration()));
        }
    }

    /// Replaces the last committed segment or ends it earlier, and commits what was stored behind it up to the n-th segment
    /// ever, which ends at rest. Returns how much longer the committed path is [s].
    pub(super) fn splice(&mut self, change: Change<'_>, n: u32) -> f32 {
        let (before, begins) = (self.committed.end, self.last_begins());
        if let Some(last) = self
            .slots
            .get_mut(slot(self.committed.count.wrapping_sub(1)))
        {
            match change {
                Change::EndAfter(duration) => last.queued.segment.end_after(duration),
                Change::Replace(queued) => {
                    last.queued.segment.copy_from(&queued.segment);
                    last.queued.open = queued.open;
                    last.queued.limits = queued.limits;
                    last.queued.extra = queued.extra;
                }
            }
            last.end = begins.wrapping_add(microseconds(last.queued.segment.duration()));
        }
        let end = self
            .slots
            .get(slot(n.wrapping_sub(1)))
            .map_or(before, |it| it.end);
        self.committed = Extent {
            count: n,
            end,
            in_motion: false,
        };
        self.pushed = self.committed;
        end.wrapping_sub(before) as i32 as f32 * 1e-6
    }

    /// The time at which the last committed segment begins [µs].
    fn last_begins(&self) -> u32 {
        let last = self.slots.get(slot(self.committed.count.wrapping_sub(1)));
        last.map_or(0, |last| {
            last.end
                .wrapping_sub(microseconds(last.queued.segment.duration()))
        })
    }

    /// Commits all pushed segments. Returns the time [s] that this adds behind the first one.
    pub(super) fn commit(&mut self) -> f32 {
        let before = self.first().map_or(0.0, |first| self.behind(first));
        self.committed = self.pushed;
        self.first()
            .map_or(0.0, |first| self.behind(first) - before)
    }

    /// Time of the segments that are pushed and not committed [s].
    pub(super) fn uncommitted(&self) -> f32 {
        self.pushed.end.wrapping_sub(self.committed.end) as f32 * 1e-6
    }

    /// Committed time behind a segment [s].
    #[inline(always)]
    pub(super) fn behind(&self, segment: &Timed) -> f32 {
        self.committed.end.wrapping_sub(segment.end) as f32 * 1e-6
    }
}

/// A duration [s] as whole microseconds.
#[inline(always)]
fn microseconds(duration: f32) -> u32 {
    ((duration * 1e6) as u32).min(LONGEST)
}

/// The slot of the n-th segment ever.
#[inline(always)]
fn slot(n: u32) -> usize {
    n as usize % QUEUED_SEGMENTS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::safety::Limits;
    use fivebar_kinematics::trajectory::TrajectorySegment;
    use nalgebra::Vector2;

    fn dwell(duration: f32) -> QueuedSegment {
        QueuedSegment {
            segment: TrajectorySegment::rest(Vector2::zeros(), duration, 0),
            open: false,
            limits: Limits::empty(),
            extra: ExtraTorque::ZERO,
        }
    }

    /// A queue after months of segments: its count and its time are about to wrap.
    fn old() -> PathQueue {
        let mut queue = PathQueue::EMPTY;
        queue.pushed.count = u32::MAX - 5;
        queue.pushed.end = u32::MAX - 1_000;
        queue.clear();
        queue
    }

    #[test]
    fn order_and_time_behind_survive_the_wrap_of_the_clock() {
        let mut queue = old();
        for n in 1..=10_u8 {
            queue.push(&dwell(1e-3 * f32::from(n)), false);
        }
        assert!(queue.is_empty() && (queue.uncommitted() - 55e-3).abs() <= 1e-5);
        queue.commit();
        assert_eq!((queue.len(), queue.uncommitted()), (10, 0.0));
        let mut behind = 55e-3;
        for n in 1..=10_u8 {
            let duration = 1e-3 * f32::from(n);
            behind -= duration;
            let first = queue.first().expect("a segment");
            assert_eq!(first.queued.segment.duration(), duration);
            // Each was cut to whole microseconds.
            assert!((queue.behind(first) - behind).abs() <= 1e-5, "{n}");
            assert_eq!(queue.is_last(), n == 10);
            queue.pass();
        }
        assert!(queue.is_last(), "the last one stays");
        queue.clear();
        assert!(queue.is_empty() && queue.first().is_none());
    }

    #[test]
    fn a_full_queue_has_no_room_until_a_segment_is_passed() {
        let mut queue = old();
        for n in 0..QUEUED_SEGMENTS {
            assert!(!queue.is_full());
            queue.push(&dwell(1e-3 * n as f32), false);
        }
        assert!(queue.is_full());
        queue.commit();
        assert_eq!(
            queue.first().map(|first| first.queued.segment.duration()),
            Some(0.0)
        );
        queue.pass();
        queue.push(&dwell(9.0), false);
    }

    #[test]
    fn what_is_not_committed_is_neither_taken_nor_lost() {
        let mut queue = old();
        queue.push(&dwell(1.0), false);
        queue.commit();
        queue.push(&dwell(2.0), false);
        queue.pass();
        let first = queue.first().expect("the committed one");
        assert_eq!(
            (first.queued.segment.duration(), queue.behind(first)),
            (1.0, 0.0)
        );
        assert!(queue.is_last());
        queue.finish();
        assert!(queue.first().is_none());
        queue.commit();
        let first = queue.first().expect("the other one");
        assert_eq!(first.queued.segment.duration(), 2.0);
    }

    #[test]
    fn a_commit_adds_the_time_of_what_it_commits_and_no_other() {
        let mut queue = old();
        let mut commit = |duration| {
            queue.push(&dwell(duration), false);
            queue.commit()
        };
        assert_eq!(commit(1.0), 0.0, "nothing is behind the first one");
        for duration in [2.0, 3.0] {
            assert!((commit(duration) - duration).abs() <= 1e-5);
        }
    }

    #[test]
    fn days_of_waiting_count_as_minutes() {
        let mut queue = old();
        for _ in 0..QUEUED_SEGMENTS {
            queue.push(&dwell(86_400.0), false);
        }
        queue.commit();
        let first = queue.first().expect("a segment");
        assert_eq!(queue.behind(first), 31.0 * 60.0);
    }
}
