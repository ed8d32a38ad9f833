//! The controller's time against real time.

use crate::clock::{Clock, Sleeper};
use std::time::{Duration, Instant};

/// Time between two comparisons with the clock.
const INTERVAL: Duration = Duration::from_millis(1);
/// A simulation that is later than this does not catch up: it continues slower than real
/// time.
const TOO_LATE: Duration = Duration::from_millis(20);
/// Time over which the speed is measured.
const SPAN: Duration = Duration::from_secs(1);

/// Delays ticks so that they keep real time.
pub(super) struct Pacer {
    ticks_per_interval: u32,
    ticks: u32,
    /// When the next interval begins.
    due: Instant,
    sleeper: Sleeper,
}

impl Pacer {
    /// A pacer for `tick_rate` ticks per second of this clock [Hz].
    pub(super) fn new(tick_rate: f64, clock: &Clock) -> Self {
        Self {
            ticks_per_interval: ((INTERVAL.as_secs_f64() * tick_rate) as u32).max(1),
            ticks: 0,
            due: clock.now(),
            sleeper: clock.sleeper(),
        }
    }

    /// Waits until the next tick is due.
    pub(super) fn tick(&mut self) {
        self.ticks += 1;
        if self.ticks < self.ticks_per_interval {
            return;
        }
        self.ticks = 0;
        self.due += INTERVAL;
        let now = self.sleeper.clock().now();
        if self.due > now {
            self.sleeper.sleep_until(self.due);
        } else if now - self.due > TOO_LATE {
            self.due = now;
        }
    }
}

/// Measures the speed of a controller's time.
pub struct SpeedMeter {
    since: (f64, Instant),
    latest: Option<f32>,
}

impl SpeedMeter {
    /// Starts measuring when the controller's time is `time` [s].
    pub fn from(time: f64, now: Instant) -> Self {
        Self {
            since: (time, now),
            latest: None,
        }
    }

    /// Seconds of the controller per real second; none in the first second.
    pub fn at(&mut self, time: f64, now: Instant) -> Option<f32> {
        let (before, then) = self.since;
        let passed = now.saturating_duration_since(then);
        if passed >= SPAN {
            self.latest = Some(((time - before) / passed.as_secs_f64()) as f32);
            self.since = (time, now);
        }
        self.latest
    }
}

#[cfg(test)]
mod tests {
    use super::{Duration, Instant, Pacer, SPAN, SpeedMeter, TOO_LATE};
    use crate::clock::Clock;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn ticks_keep_the_time_of_their_clock() {
        let clock = Clock::simulated();
        let start = clock.now();
        let mut pace = Pacer::new(10_000.0, &clock);
        for _ in 0..500 {
            pace.tick();
        }
        assert_eq!(clock.since(start), 50 * MS);
    }

    /// Other work takes a part of each millisecond, then more than a simulation may be late by.
    #[test]
    fn a_short_delay_is_made_up_for_and_a_long_one_is_not() {
        let clock = Clock::simulated();
        let start = clock.now();
        let mut pace = Pacer::new(10_000.0, &clock);
        for _ in 0..10 {
            clock.sleep(MS / 2);
            (0..10).for_each(|_| pace.tick());
        }
        assert_eq!(clock.since(start), 10 * MS);
        let late = TOO_LATE + 5 * MS;
        clock.sleep(late);
        (0..100).for_each(|_| pace.tick());
        // The interval during which it was late has passed by then.
        assert_eq!(clock.since(start), 10 * MS + late + 9 * MS);
    }

    #[test]
    fn speed_is_known_after_a_second() {
        let start = Instant::now();
        let mut speed = SpeedMeter::from(2.0, start);
        assert_eq!(speed.at(2.05, start + SPAN / 2), None);
        assert_eq!(speed.at(2.25, start + SPAN), Some(0.25));
        assert_eq!(speed.at(2.75, start + 2 * SPAN), Some(0.5));
    }
}
