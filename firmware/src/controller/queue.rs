//! The stretches of path that wait for the tick: a ring, and the time that they take.
//!
//! Each stretch knows when it ends on a clock of its own, the sum of all that were pushed.
//! The time behind one of them is then a difference of two, however many were left behind,
//! and counted in whole microseconds it gathers no rounding.
//!
//! What is pushed is out of the tick's sight until it is committed.

use super::Stretch;
use crate::safety::Limits;
use fivebar_kinematics::Vec2;
use fivebar_kinematics::trajectory::Piece;

/// Pieces that wait for the tick: the committed future of the arm.
pub const PIECES: usize = 32;

/// The longest that a piece counts for [µs]: nobody asks how much more there is, and the
/// sum of all stays far from overflow.
const LONGEST: u32 = 60_000_000;

/// A stretch and where it lies.
#[derive(Clone, Copy)]
pub(super) struct Queued {
    pub(super) stretch: Stretch,
    /// The sum of the durations up to its end, wrapping [µs].
    end: u32,
}

/// The ring. All counts wrap, and `PIECES` divides their range.
#[repr(C)]
pub(super) struct Queue {
    /// Stretches that were left behind.
    first: u32,
    /// Stretches that were committed.
    next: u32,
    /// Where the last one of them ends [µs].
    end: u32,
    /// Stretches that were pushed.
    pushed: u32,
    /// Where the last one of them ends [µs].
    pushed_end: u32,
    slots: [Queued; PIECES],
}

impl Queue {
    pub(super) fn new() -> Self {
        let nothing = Stretch {
            piece: Piece::rest(Vec2::zero(), 0.0, 0),
            open: false,
            limits: Limits::NONE,
        };
        Self {
            first: 0,
            next: 0,
            end: 0,
            pushed: 0,
            pushed_end: 0,
            slots: [Queued {
                stretch: nothing,
                end: 0,
            }; PIECES],
        }
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.commit();
        self.finish();
    }

    /// Leaves all behind that was committed.
    pub(super) fn finish(&mut self) {
        self.first = self.next;
    }

    /// Whether nothing is committed.
    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.first == self.next
    }

    /// Committed stretches, the first one included.
    #[inline(always)]
    pub(super) fn len(&self) -> u32 {
        self.next.wrapping_sub(self.first)
    }

    /// Whether there is no room for another stretch.
    pub(super) fn is_full(&self) -> bool {
        self.pushed.wrapping_sub(self.first) == PIECES as u32
    }

    /// Whether one stretch is all that is committed.
    #[inline(always)]
    pub(super) fn is_last(&self) -> bool {
        self.first.wrapping_add(1) == self.next
    }

    /// The stretch in progress.
    #[inline(always)]
    pub(super) fn first(&self) -> Option<&Queued> {
        if self.is_empty() {
            return None;
        }
        self.slots.get(slot(self.first))
    }

    /// Leaves the first stretch behind; the last committed one stays.
    #[inline(always)]
    pub(super) fn leave(&mut self) {
        if !self.is_empty() && !self.is_last() {
            self.first = self.first.wrapping_add(1);
        }
    }

    /// Appends a stretch; gives it back where there is no room.
    pub(super) fn push(&mut self, stretch: Stretch) -> Result<(), Stretch> {
        if self.is_full() {
            return Err(stretch);
        }
        let Some(place) = self.slots.get_mut(slot(self.pushed)) else {
            return Err(stretch);
        };
        let duration = ((stretch.piece.duration() * 1e6) as u32).min(LONGEST);
        self.pushed_end = self.pushed_end.wrapping_add(duration);
        self.pushed = self.pushed.wrapping_add(1);
        *place = Queued {
            stretch,
            end: self.pushed_end,
        };
        Ok(())
    }

    /// Commits all that was pushed.
    pub(super) fn commit(&mut self) {
        self.next = self.pushed;
        self.end = self.pushed_end;
    }

    /// The time that was pushed and not committed [s].
    pub(super) fn uncommitted(&self) -> f32 {
        self.pushed_end.wrapping_sub(self.end) as f32 * 1e-6
    }

    /// The committed time that `queued` leaves behind it [s].
    #[inline(always)]
    pub(super) fn behind(&self, queued: &Queued) -> f32 {
        self.end.wrapping_sub(queued.end) as f32 * 1e-6
    }
}

/// The slot of the n-th stretch ever.
#[inline(always)]
fn slot(n: u32) -> usize {
    n as usize % PIECES
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dwell(duration: f32) -> Stretch {
        Stretch {
            piece: Piece::rest(Vec2::zero(), duration, 0),
            open: false,
            limits: Limits::NONE,
        }
    }

    /// After months of pieces: every count is about to wrap.
    fn old() -> Queue {
        let mut queue = Queue::new();
        queue.pushed = u32::MAX - 5;
        queue.pushed_end = u32::MAX - 1_000;
        queue.clear();
        queue
    }

    #[test]
    fn order_and_time_behind_survive_the_wrap_of_every_count() {
        let mut queue = old();
        for n in 1..=10_u8 {
            queue.push(dwell(1e-3 * f32::from(n))).expect("room");
        }
        assert!(queue.is_empty() && (queue.uncommitted() - 55e-3).abs() <= 1e-5);
        queue.commit();
        assert_eq!((queue.len(), queue.uncommitted()), (10, 0.0));
        let mut behind = 55e-3;
        for n in 1..=10_u8 {
            let duration = 1e-3 * f32::from(n);
            behind -= duration;
            let first = queue.first().expect("a stretch");
            assert_eq!(first.stretch.piece.duration(), duration);
            // Each was cut to whole microseconds.
            assert!((queue.behind(first) - behind).abs() <= 1e-5, "{n}");
            assert_eq!(queue.is_last(), n == 10);
            queue.leave();
        }
        assert!(queue.is_last(), "the last one stays");
        queue.clear();
        assert!(queue.is_empty() && queue.first().is_none());
    }

    #[test]
    fn a_full_queue_gives_a_stretch_back_and_keeps_what_it_has() {
        let mut queue = old();
        for n in 0..PIECES {
            assert!(!queue.is_full());
            queue.push(dwell(1e-3 * n as f32)).expect("room");
        }
        assert!(queue.is_full() && queue.push(dwell(9.0)).is_err());
        queue.commit();
        assert_eq!(
            queue.first().map(|first| first.stretch.piece.duration()),
            Some(0.0)
        );
        queue.leave();
        queue.push(dwell(9.0)).expect("room");
    }

    #[test]
    fn what_is_not_committed_is_neither_taken_nor_lost() {
        let mut queue = old();
        queue.push(dwell(1.0)).expect("room");
        queue.commit();
        queue.push(dwell(2.0)).expect("room");
        queue.leave();
        let first = queue.first().expect("the committed one");
        assert_eq!(
            (first.stretch.piece.duration(), queue.behind(first)),
            (1.0, 0.0)
        );
        assert!(queue.is_last());
        queue.finish();
        assert!(queue.first().is_none());
        queue.commit();
        let first = queue.first().expect("the other one");
        assert_eq!(first.stretch.piece.duration(), 2.0);
    }

    #[test]
    fn days_of_waiting_count_as_minutes() {
        let mut queue = old();
        for _ in 0..PIECES {
            queue.push(dwell(86_400.0)).expect("room");
        }
        queue.commit();
        let first = queue.first().expect("a stretch");
        assert_eq!(queue.behind(first), 31.0 * 60.0);
    }
}
