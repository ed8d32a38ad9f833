//! Stops that pages ask for, on a path past every queue.

use super::lease::PageId;
use serde::Serialize;
use std::sync::atomic::{AtomicU64, Ordering};

/// A request that any page may make, because it makes the arm safer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(in crate::serve) enum Stop {
    /// Along the path to rest.
    #[serde(rename = "stop")]
    OnPath,
    /// Bridges off.
    #[serde(rename = "emergency_stop")]
    Emergency,
}

impl Stop {
    /// The number of kinds.
    pub(in crate::serve) const KINDS: usize = 2;
}

/// The stops that wait for the controller's thread: at most one of each kind, however many
/// pages ask for it. A page's thread raises them when it receives them; the controller's thread
/// looks here before each exchange with the controller.
#[derive(Debug, Default)]
pub(in crate::serve) struct StopSignal {
    /// The page that asked last; 0 if nobody did.
    emergency: AtomicU64,
    on_path: AtomicU64,
    raised: AtomicU64,
}

impl StopSignal {
    /// Asks for a stop.
    pub(in crate::serve) fn raise(&self, stop: Stop, page: PageId) {
        self.raised.fetch_add(1, Ordering::SeqCst);
        self.of(stop).store(page, Ordering::SeqCst);
    }

    /// The stop to do now and the page that asked for it; the emergency stop first.
    pub(in crate::serve) fn take(&self) -> Option<(Stop, PageId)> {
        [Stop::Emergency, Stop::OnPath]
            .into_iter()
            .find_map(|stop| {
                let page = self.of(stop).swap(0, Ordering::SeqCst);
                (page != 0).then_some((stop, page))
            })
    }

    /// How many stops were asked for so far. A request with a smaller number is older than the
    /// last stop.
    pub(in crate::serve) fn count(&self) -> u64 {
        self.raised.load(Ordering::SeqCst)
    }

    fn of(&self, stop: Stop) -> &AtomicU64 {
        match stop {
            Stop::Emergency => &self.emergency,
            Stop::OnPath => &self.on_path,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Stop, StopSignal};

    #[test]
    fn a_thousand_stops_are_one_and_the_emergency_stop_comes_first() {
        let signal = StopSignal::default();
        for page in 1..=1000 {
            signal.raise(Stop::OnPath, page);
        }
        signal.raise(Stop::Emergency, 7);
        assert_eq!(signal.take(), Some((Stop::Emergency, 7)));
        assert_eq!(signal.take(), Some((Stop::OnPath, 1000)));
        assert_eq!(signal.take(), None);
        assert_eq!(signal.count(), 1001);
    }
}
