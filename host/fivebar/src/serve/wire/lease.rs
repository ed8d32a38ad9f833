//! A page's connection, and the control lease: which page may move the arm, and for how long.
//!
//! A page's thread renews and ends the lease when it receives bytes of the page or loses it; the
//! controller's thread gives it and asks for it. Both use atomic numbers, so that
//! neither waits for the other or for a queue between them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tokio::sync::Semaphore;

/// The number that a page gets when it connects; the first is 1.
pub(in crate::serve) type PageId = u64;

/// Requests of one page that may wait for the controller's thread. Requests of all pages wait in one
/// queue: those of a page that floods would keep the others' waiting, on a port a round trip each.
pub(super) const REQUESTS: usize = 32;
/// The page in control counts as lost after this time, which begins before its last message arrived
/// ([`Page::received`]). Every page, also a hidden one, sends a sign of life every 50 ms. With the
/// controller's command timeout (0.1 s) and the ramp to rest that follows it (0.11 s for the benchtop
/// arm), the arm rests within 0.7 s.
pub(in crate::serve) const TIMEOUT: Duration = Duration::from_millis(350);

/// No page.
const NONE: PageId = 0;

/// A page's connection.
#[derive(Debug)]
pub(in crate::serve) struct Page {
    pub(in crate::serve) id: PageId,
    connected: AtomicBool,
    pub(super) places: Arc<Semaphore>,
    begun: Instant,
    /// See [`Page::received`] [µs after `begun`].
    received: AtomicU64,
}

impl Page {
    /// A page with a number of its own, which has connected at this time.
    pub(in crate::serve) fn new(now: Instant) -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(1);
        Self {
            id: COUNT.fetch_add(1, Ordering::Relaxed),
            connected: AtomicBool::new(true),
            places: Arc::new(Semaphore::new(REQUESTS)),
            begun: now,
            received: AtomicU64::new(0),
        }
    }

    /// A time at which the page certainly lived: its latest bytes arrived after it. What waited for
    /// the server, however long, counts for no later time.
    pub(in crate::serve) fn received(&self) -> Instant {
        self.begun + Duration::from_micros(self.received.load(Ordering::SeqCst))
    }

    pub(in crate::serve) fn set_received(&self, received: Instant) {
        let time = received.saturating_duration_since(self.begun);
        self.received
            .store(time.as_micros() as u64, Ordering::SeqCst);
    }

    pub(in crate::serve) fn is_connected(&self) -> bool {
        self.connected.load(Ordering::SeqCst)
    }

    /// Ends the page's control at once. Its requests that still wait are dropped.
    pub(in crate::serve) fn disconnect(&self, lease: &ControlLease) {
        self.connected.store(false, Ordering::SeqCst);
        lease.release(self.id);
    }
}

/// The page in control, if there is one. The caller passes the time.
#[derive(Debug)]
pub(in crate::serve) struct ControlLease {
    start: Instant,
    holder: AtomicU64,
    /// When the last bytes of the page in control arrived [µs after `start`].
    renewed: AtomicU64,
}

impl ControlLease {
    pub(in crate::serve) fn new(now: Instant) -> Self {
        Self {
            start: now,
            holder: AtomicU64::new(NONE),
            renewed: AtomicU64::new(0),
        }
    }

    /// The page in control.
    pub(in crate::serve) fn holder(&self) -> Option<PageId> {
        let holder = self.holder.load(Ordering::SeqCst);
        (holder != NONE).then_some(holder)
    }

    /// Whether a page is in control and its lease has not run out.
    pub(in crate::serve) fn is_alive(&self, now: Instant) -> bool {
        let renewed = Duration::from_micros(self.renewed.load(Ordering::SeqCst));
        let passed = now.saturating_duration_since(self.start + renewed);
        self.holder().is_some() && passed < TIMEOUT
    }

    /// Whether this page is in control and its lease has not run out.
    pub(in crate::serve) fn is_held_by(&self, page: PageId, now: Instant) -> bool {
        self.holder() == Some(page) && self.is_alive(now)
    }

    /// Gives control to a page that asked for it at `asked`: to any connected page while the arm
    /// rests, else only if no living page has it. Returns whether the page has control now.
    pub(in crate::serve) fn acquire(
        &self,
        page: &Page,
        asked: Instant,
        now: Instant,
        rests: bool,
    ) -> bool {
        if self.holder() == Some(page.id) {
            self.stamp(page.received());
        } else if rests || !self.is_alive(now) {
            self.stamp(asked);
            self.holder.store(page.id, Ordering::SeqCst);
            // The page may have been lost since it asked; `release` then came too early.
            if !page.is_connected() {
                self.release(page.id);
            }
        }
        self.holder() == Some(page.id)
    }

    /// Renews the lease if this page holds it.
    pub(in crate::serve) fn renew(&self, page: &Page) {
        if self.holder() == Some(page.id) {
            self.stamp(page.received());
        }
    }

    /// Ends the lease if this page holds it.
    pub(in crate::serve) fn release(&self, page: PageId) {
        let held = self
            .holder
            .compare_exchange(page, NONE, Ordering::SeqCst, Ordering::SeqCst);
        // Another page, or none, is in control: there is nothing to end.
        let _ = held;
    }

    fn stamp(&self, received: Instant) {
        let time = received.saturating_duration_since(self.start);
        self.renewed
            .fetch_max(time.as_micros() as u64, Ordering::SeqCst);
    }
}

#[cfg(test)]
mod tests {
    use super::{ControlLease, TIMEOUT};
    use crate::serve::wire::lease::Page;
    use std::time::{Duration, Instant};

    #[test]
    fn one_page_controls_a_moving_arm_until_it_disconnects_or_its_lease_ends() {
        let start = Instant::now();
        let lease = ControlLease::new(start);
        let [one, two] = [Page::new(start), Page::new(start)];
        assert!(!lease.is_alive(start));
        assert!(lease.acquire(&one, start, start, false));
        assert!(!lease.acquire(&two, start, start, false));
        let late = start + TIMEOUT;
        one.set_received(late - Duration::from_millis(1));
        lease.renew(&one);
        assert!(lease.is_alive(late) && !lease.acquire(&two, late, late, false));
        let later = late + TIMEOUT;
        assert!(!lease.is_held_by(one.id, later));
        assert!(lease.acquire(&two, later, later, false));
        assert!(!lease.is_held_by(one.id, later) && lease.is_held_by(two.id, later));
        lease.release(one.id);
        assert_eq!(lease.holder(), Some(two.id));
        lease.release(two.id);
        assert_eq!(lease.holder(), None);
    }

    #[test]
    fn another_page_takes_over_while_the_arm_rests() {
        let now = Instant::now();
        let lease = ControlLease::new(now);
        let [one, two] = [Page::new(now), Page::new(now)];
        assert!(lease.acquire(&one, now, now, true) && lease.acquire(&two, now, now, true));
        one.set_received(now + TIMEOUT);
        lease.renew(&one);
        assert!(!lease.is_alive(now + TIMEOUT), "only the holder renews");
    }

    #[test]
    fn a_lost_page_gets_no_control_by_a_request_that_it_left_behind() {
        let now = Instant::now();
        let lease = ControlLease::new(now);
        let page = Page::new(now);
        page.disconnect(&lease);
        assert!(!lease.acquire(&page, now, now, true));
        assert_eq!(lease.holder(), None);
    }

    #[test]
    fn a_lease_counts_from_the_time_at_which_its_page_sent() {
        let received = Instant::now();
        let lease = ControlLease::new(received);
        let page = Page::new(received);
        let handled = received + TIMEOUT / 2;
        assert!(lease.acquire(&page, received, handled, true));
        assert!(!lease.is_alive(received + TIMEOUT));
    }

    /// A page that floods leaves requests for control behind when it is lost.
    #[test]
    fn requests_for_control_that_are_handled_late_renew_nothing() {
        let start = Instant::now();
        let lease = ControlLease::new(start);
        let page = Page::new(start);
        let late = start + TIMEOUT;
        assert!(lease.acquire(&page, start, start, true));
        assert!(lease.acquire(&page, late, late, true));
        assert!(!lease.is_alive(late + Duration::from_millis(1)));
    }
}
