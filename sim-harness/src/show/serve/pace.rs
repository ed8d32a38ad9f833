//! The controller's time and the clock on the wall.

use std::thread;
use std::time::{Duration, Instant};

/// Time that passes between two looks at the clock.
const LOOK: Duration = Duration::from_millis(1);
/// A simulation this late goes on from where it is, slower than time, instead of racing.
const TOO_LATE: Duration = Duration::from_millis(100);
/// Speed is measured over so long.
const SPAN: Duration = Duration::from_secs(1);

/// Holds ticks back to the clock.
pub(super) struct Pace {
    ticks_per_look: u32,
    ticks: u32,
    /// When the next look is due.
    due: Instant,
}

impl Pace {
    /// For so many ticks a second.
    pub(super) fn new(tick_rate: f64) -> Self {
        Self {
            ticks_per_look: ((LOOK.as_secs_f64() * tick_rate) as u32).max(1),
            ticks: 0,
            due: Instant::now(),
        }
    }

    /// Waits until the next tick is due.
    pub(super) fn tick(&mut self) {
        self.ticks += 1;
        if self.ticks < self.ticks_per_look {
            return;
        }
        self.ticks = 0;
        self.due += LOOK;
        let now = Instant::now();
        match self.due.checked_duration_since(now) {
            Some(early) => thread::sleep(early),
            None if now - self.due > TOO_LATE => self.due = now,
            None => {}
        }
    }
}

/// Measures how fast a controller's time goes.
pub(super) struct Speed {
    since: (f64, Instant),
    latest: Option<f32>,
}

impl Speed {
    /// Begins where the controller's time is `time` [s].
    pub(super) fn from(time: f64, now: Instant) -> Self {
        Self {
            since: (time, now),
            latest: None,
        }
    }

    /// Seconds of the controller per second of the clock; none in the first second.
    pub(super) fn at(&mut self, time: f64, now: Instant) -> Option<f32> {
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
    use super::{Duration, Instant, Pace, SPAN, Speed};

    #[test]
    fn ticks_take_as_long_as_they_should() {
        let start = Instant::now();
        let mut pace = Pace::new(10_000.0);
        for _ in 0..500 {
            pace.tick();
        }
        // A busy machine may take longer, never shorter.
        assert!(start.elapsed() >= Duration::from_millis(49));
    }

    #[test]
    fn speed_is_known_after_a_second() {
        let start = Instant::now();
        let mut speed = Speed::from(2.0, start);
        assert_eq!(speed.at(2.05, start + SPAN / 2), None);
        assert_eq!(speed.at(2.25, start + SPAN), Some(0.25));
        assert_eq!(speed.at(2.75, start + 2 * SPAN), Some(0.5));
    }
}
