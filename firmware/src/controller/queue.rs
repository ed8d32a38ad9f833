//! The stretches of path that wait for the tick: a ring, and the time that they take.
//!
//! Each stretch knows when it ends on a clock of its own, the sum of all that were pushed.
//! The time behind one of them is then a difference of two, however many were left behind,
//! and counted in whole microseconds it gathers no rounding.

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

/// The ring. Both counts wrap, and `PIECES` divides their range.
#[repr(C)]
pub(super) struct Queue {
    /// Stretches that were left behind.
    first: u32,
    /// Stretches that were pushed.
    next: u32,
    /// Where the last one ends [µs].
    end: u32,
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
            slots: [Queued {
                stretch: nothing,
                end: 0,
            }; PIECES],
        }
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.first = self.next;
    }

    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.first == self.next
    }

    pub(super) fn is_full(&self) -> bool {
        self.next.wrapping_sub(self.first) == PIECES as u32
    }

    /// Whether one stretch is all there is.
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

    /// Leaves the first stretch behind; the last one stays.
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
        let Some(place) = self.slots.get_mut(slot(self.next)) else {
            return Err(stretch);
        };
        let duration = ((stretch.piece.duration() * 1e6) as u32).min(LONGEST);
        self.end = self.end.wrapping_add(duration);
        self.next = self.next.wrapping_add(1);
        *place = Queued {
            stretch,
            end: self.end,
        };
        Ok(())
    }

    /// The time that `queued` leaves behind it [s].
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
