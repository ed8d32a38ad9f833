//! How often something may happen.

use std::time::{Duration, Instant};

/// Counts events and admits so many per second.
#[derive(Debug)]
pub(super) struct PerSecond {
    limit: u32,
    since: Instant,
    count: u32,
}

impl PerSecond {
    pub(super) fn new(limit: u32, now: Instant) -> Self {
        Self {
            limit,
            since: now,
            count: 0,
        }
    }

    /// Counts one event; returns whether it is within the limit.
    pub(super) fn admit(&mut self, now: Instant) -> bool {
        if now.saturating_duration_since(self.since) >= Duration::from_secs(1) {
            self.since = now;
            self.count = 0;
        }
        self.count += 1;
        self.count <= self.limit
    }
}
