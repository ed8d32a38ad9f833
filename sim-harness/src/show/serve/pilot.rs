//! Which page is in control, and whether it lives.

use std::time::{Duration, Instant};

/// A page's number, given when it connects.
pub(super) type PageId = u64;

/// A page in control that has not been heard for so long is taken to be lost. Pages say
/// that they are alive every 50 ms, hidden ones too.
const PATIENCE: Duration = Duration::from_millis(500);

/// The page in control, if there is one. Time is told by the caller.
#[derive(Debug, Default)]
pub(super) struct Pilot {
    in_control: Option<(PageId, Instant)>,
}

impl Pilot {
    /// The page in control.
    pub(super) fn page(&self) -> Option<PageId> {
        self.in_control.map(|(page, _)| page)
    }

    /// Whether there is one, and it has been heard lately.
    pub(super) fn is_alive(&self, now: Instant) -> bool {
        self.in_control
            .is_some_and(|(_, heard)| now.saturating_duration_since(heard) < PATIENCE)
    }

    /// Gives control to a page: while the arm rests to any, else only where no living page
    /// has it. Whether it has it now.
    pub(super) fn take(&mut self, page: PageId, now: Instant, rests: bool) -> bool {
        if rests || self.page() == Some(page) || !self.is_alive(now) {
            self.in_control = Some((page, now));
        }
        self.page() == Some(page)
    }

    /// Notes that a page has been heard. Whether it is in control.
    pub(super) fn hear(&mut self, page: PageId, now: Instant) -> bool {
        match &mut self.in_control {
            Some((pilot, heard)) if *pilot == page => {
                *heard = now;
                true
            }
            _ => false,
        }
    }

    /// A page has gone. Whether it was in control.
    pub(super) fn leave(&mut self, page: PageId) -> bool {
        let left = self.in_control.take_if(|(pilot, _)| *pilot == page);
        left.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::{PATIENCE, Pilot};
    use std::time::{Duration, Instant};

    #[test]
    fn one_page_is_in_control_of_a_moving_arm_until_it_leaves_or_falls_silent() {
        let start = Instant::now();
        let mut pilot = Pilot::default();
        assert!(!pilot.is_alive(start));
        assert!(pilot.take(1, start, false));
        assert!(!pilot.take(2, start, false) && !pilot.hear(2, start));
        let late = start + PATIENCE;
        assert!(pilot.hear(1, late - Duration::from_millis(1)));
        assert!(pilot.is_alive(late) && !pilot.take(2, late, false));
        assert!(pilot.take(2, late + PATIENCE, false));
        assert!(
            !pilot.hear(1, late + PATIENCE),
            "the first page was given up"
        );
        assert!(!pilot.leave(1) && pilot.page() == Some(2));
        assert!(pilot.leave(2) && pilot.page().is_none());
    }

    #[test]
    fn another_page_takes_over_while_the_arm_rests() {
        let now = Instant::now();
        let mut pilot = Pilot::default();
        assert!(pilot.take(1, now, true) && pilot.take(2, now, true));
        assert!(!pilot.hear(1, now) && pilot.hear(2, now));
    }
}
