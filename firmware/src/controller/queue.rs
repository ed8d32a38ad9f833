//! The stretches of path that wait for the tick: a ring, and the time that they take.
//!
//! Each stretch knows when it ends on a clock of its own, the sum of all that were pushed.
//! The time behind one of them is then a difference of two, however many were left behind,
//! and counted in whole microseconds it gathers no rounding.

use super::Stretch;

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
pub(super) struct Queue {
    /// Stretches that were left behind.
    first: u32,
    /// Stretches that were pushed.
    next: u32,
    /// Where the last one ends [µs].
    end: u32,
    slots: [Option<Queued>; PIECES],
}

impl Queue {
    pub(super) fn new() -> Self {
        Self {
            first: 0,
            next: 0,
            end: 0,
            slots: [None; PIECES],
        }
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.first = self.next;
    }

    /// Stretches that wait, the first one included.
    #[inline(always)]
    pub(super) fn len(&self) -> u32 {
        self.next.wrapping_sub(self.first)
    }

    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(super) fn is_full(&self) -> bool {
        self.len() == PIECES as u32
    }

    /// The stretch in progress.
    #[inline(always)]
    pub(super) fn first(&self) -> Option<&Queued> {
        if self.is_empty() {
            return None;
        }
        self.slots.get(slot(self.first))?.as_ref()
    }

    /// Leaves the first stretch behind; the last one stays.
    #[inline(always)]
    pub(super) fn leave(&mut self) {
        if self.len() > 1 {
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
        *place = Some(Queued {
            stretch,
            end: self.end,
        });
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
