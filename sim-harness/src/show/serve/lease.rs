//! The control lease: which page may move the arm, and for how long.

use std::time::{Duration, Instant};

/// The number that a page gets when it connects.
pub(super) type PageId = u64;

/// The page in control counts as lost after this time without a message. Every page, also a
/// hidden one, sends a sign of life every 50 ms.
const TIMEOUT: Duration = Duration::from_millis(500);

/// The page in control, if there is one. The caller passes the time.
#[derive(Debug, Default)]
pub(super) struct ControlLease {
    held_by: Option<(PageId, Instant)>,
}

impl ControlLease {
    /// The page in control.
    pub(super) fn holder(&self) -> Option<PageId> {
        self.held_by.map(|(page, _)| page)
    }

    /// Whether a page is in control and its lease has not run out.
    pub(super) fn is_alive(&self, now: Instant) -> bool {
        self.held_by
            .is_some_and(|(_, renewed)| now.saturating_duration_since(renewed) < TIMEOUT)
    }

    /// Gives control to a page: to any page while the arm rests, else only if no living page
    /// has it. Returns whether the page has control now.
    pub(super) fn acquire(&mut self, page: PageId, now: Instant, rests: bool) -> bool {
        if rests || self.holder() == Some(page) || !self.is_alive(now) {
            self.held_by = Some((page, now));
        }
        self.holder() == Some(page)
    }

    /// Renews the lease if this page holds it. Returns whether it does.
    pub(super) fn renew(&mut self, page: PageId, now: Instant) -> bool {
        match &mut self.held_by {
            Some((holder, renewed)) if *holder == page => {
                *renewed = now;
                true
            }
            _ => false,
        }
    }

    /// Ends the lease if this page holds it. Returns whether it did.
    pub(super) fn release(&mut self, page: PageId) -> bool {
        let left = self.held_by.take_if(|(holder, _)| *holder == page);
        left.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::{ControlLease, TIMEOUT};
    use std::time::{Duration, Instant};

    #[test]
    fn one_page_controls_a_moving_arm_until_it_disconnects_or_its_lease_ends() {
        let start = Instant::now();
        let mut lease = ControlLease::default();
        assert!(!lease.is_alive(start));
        assert!(lease.acquire(1, start, false));
        assert!(!lease.acquire(2, start, false) && !lease.renew(2, start));
        let late = start + TIMEOUT;
        assert!(lease.renew(1, late - Duration::from_millis(1)));
        assert!(lease.is_alive(late) && !lease.acquire(2, late, false));
        assert!(lease.acquire(2, late + TIMEOUT, false));
        assert!(
            !lease.renew(1, late + TIMEOUT),
            "the second page has control now"
        );
        assert!(!lease.release(1) && lease.holder() == Some(2));
        assert!(lease.release(2) && lease.holder().is_none());
    }

    #[test]
    fn another_page_takes_over_while_the_arm_rests() {
        let now = Instant::now();
        let mut lease = ControlLease::default();
        assert!(lease.acquire(1, now, true) && lease.acquire(2, now, true));
        assert!(!lease.renew(1, now) && lease.renew(2, now));
    }
}
