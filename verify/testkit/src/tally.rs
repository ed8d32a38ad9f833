//! Counts of accepted and refused cases.

use std::cell::Cell;

/// Counts how many random cases the code under test accepted.
///
/// A test that skips refused cases passes when everything is refused. It counts them here
/// and asserts the share that must be accepted.
///
/// ```
/// let tally = fivebar_testkit::Tally::default();
/// for number in 0..100_u8 {
///     if !tally.count(number.checked_add(200).is_some()) {
///         continue;
///     }
/// }
/// tally.assert_accepted(0.5);
/// assert_eq!((tally.accepted(), tally.refused()), (56, 44));
/// ```
#[derive(Debug, Default)]
pub struct Tally {
    accepted: Cell<u32>,
    refused: Cell<u32>,
}

impl Tally {
    /// Counts a case and returns `accepted`.
    pub fn count(&self, accepted: bool) -> bool {
        let counter = if accepted {
            &self.accepted
        } else {
            &self.refused
        };
        counter.set(counter.get() + 1);
        accepted
    }

    /// Cases accepted so far.
    pub fn accepted(&self) -> u32 {
        self.accepted.get()
    }

    /// Cases refused so far.
    pub fn refused(&self) -> u32 {
        self.refused.get()
    }

    /// Share of the cases that was accepted, 0 to 1; 0 of no cases.
    pub fn share(&self) -> f64 {
        let all = self.accepted() + self.refused();
        f64::from(self.accepted()) / f64::from(all.max(1))
    }

    /// Asserts that at least this share of the cases was accepted.
    ///
    /// # Panics
    /// If it was less.
    #[track_caller]
    pub fn assert_accepted(&self, least: f64) {
        assert!(self.share() >= least, "{self:?}, at least {least} expected");
    }

    /// Asserts that at least this share of the cases was refused: that the test met both.
    ///
    /// # Panics
    /// If it was less, or no case was counted.
    #[track_caller]
    pub fn assert_refused(&self, least: f64) {
        let met = self.refused() > 0 && 1.0 - self.share() >= least;
        assert!(met, "{self:?}, at least {least} refused expected");
    }
}
