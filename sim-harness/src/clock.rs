//! The time by which a program waits and measures: that of the machine, or one that a test passes.
//!
//! Whatever keeps time has a [`Clock`], so that what a test finds does not depend on how busy the machine is. A virtual
//! clock passes in one of two ways. *Free*, it jumps ahead to whatever waits: a run takes as long as its work. *Held*, it
//! stands still until [`Clock::advance`], which returns when all that its time wakes waits again.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// A source of time; clones share it.
#[derive(Clone, Debug)]
pub struct Clock(Source);

#[derive(Clone, Debug)]
enum Source {
    Real,
    Virtual(Arc<Virtual>),
}

#[derive(Debug)]
struct Virtual {
    start: Instant,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    /// Time since the start.
    passed: Duration,
    is_held: bool,
    /// When each sleeper is to wake; none while it works, or when it is gone.
    sleepers: Vec<Sleep>,
}

/// What a sleeper does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sleep {
    Works,
    Until(Duration),
    Gone,
}

impl Clock {
    /// The machine's time.
    pub const fn real() -> Self {
        Self(Source::Real)
    }

    /// A virtual time, which is free at first.
    pub fn simulated() -> Self {
        Self(Source::Virtual(Arc::new(Virtual {
            start: Instant::now(),
            state: Mutex::default(),
            changed: Condvar::new(),
        })))
    }

    /// The present time.
    pub fn now(&self) -> Instant {
        match &self.0 {
            Source::Real => Instant::now(),
            Source::Virtual(time) => time.start + time.state().passed,
        }
    }

    /// The time since `then`; 0 if that is later.
    pub fn since(&self, then: Instant) -> Duration {
        self.now().saturating_duration_since(then)
    }

    /// Something that waits by this clock again and again. [`Clock::advance`] waits for it while it works.
    pub fn sleeper(&self) -> Sleeper {
        let place = match &self.0 {
            Source::Real => 0,
            Source::Virtual(time) => {
                let mut state = time.state();
                state.sleepers.push(Sleep::Works);
                state.sleepers.len() - 1
            }
        };
        let clock = self.clone();
        Sleeper { clock, place }
    }

    /// Waits for this long.
    pub fn sleep(&self, duration: Duration) {
        self.sleeper().sleep_until(self.now() + duration);
    }

    /// Lets a virtual time stand still until it is advanced. The machine's time goes on.
    pub fn hold(&self) {
        self.set_held(true);
    }

    /// Lets a virtual time jump ahead to whatever waits.
    pub fn release(&self) {
        self.set_held(false);
    }

    fn set_held(&self, is_held: bool) {
        if let Source::Virtual(time) = &self.0 {
            time.state().is_held = is_held;
            time.changed.notify_all();
        }
    }

    /// Passes virtual time. Each sleeper wakes at its own time and does its work, and all of them wait again when this
    /// returns. The machine's time is waited for.
    pub fn advance(&self, duration: Duration) {
        match &self.0 {
            Source::Real => thread::sleep(duration),
            Source::Virtual(time) => time.advance(duration),
        }
    }
}

impl Virtual {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        let waited = self.changed.wait(state);
        waited.unwrap_or_else(PoisonError::into_inner)
    }

    fn advance(&self, duration: Duration) {
        let mut state = self.state();
        let end = state.passed + duration;
        loop {
            while state.sleepers.contains(&Sleep::Works) {
                state = self.wait(state);
            }
            let due = state.sleepers.iter().filter_map(|sleep| match sleep {
                Sleep::Until(due) if *due <= end => Some(*due),
                _ => None,
            });
            let Some(due) = due.min() else { break };
            state.pass_to(due);
            self.changed.notify_all();
        }
        state.passed = end.max(state.passed);
    }

    fn sleep(&self, place: usize, due: Instant) {
        let due = due.saturating_duration_since(self.start);
        let mut state = self.state();
        if due <= state.passed {
            return;
        }
        state.sleepers[place] = Sleep::Until(due);
        self.changed.notify_all();
        loop {
            if !state.is_held {
                let now = due.max(state.passed);
                state.pass_to(now);
                self.changed.notify_all();
            }
            if state.sleepers[place] == Sleep::Works {
                return;
            }
            state = self.wait(state);
        }
    }
}

impl State {
    /// It is this late: whoever waited for it works.
    fn pass_to(&mut self, now: Duration) {
        self.passed = now;
        for sleep in &mut self.sleepers {
            if matches!(sleep, Sleep::Until(due) if *due <= now) {
                *sleep = Sleep::Works;
            }
        }
    }
}

/// What waits by a clock again and again, such as the simulated arm. It counts as working between its waits.
#[derive(Debug)]
pub struct Sleeper {
    clock: Clock,
    place: usize,
}

impl Sleeper {
    /// Waits until then.
    pub fn sleep_until(&self, due: Instant) {
        match &self.clock.0 {
            Source::Real => thread::sleep(due.saturating_duration_since(Instant::now())),
            Source::Virtual(time) => time.sleep(self.place, due),
        }
    }

    /// The clock.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }
}

impl Drop for Sleeper {
    fn drop(&mut self) {
        if let Source::Virtual(time) = &self.clock.0 {
            time.state().sleepers[self.place] = Sleep::Gone;
            time.changed.notify_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Clock;
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::thread;
    use std::time::Duration;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn a_free_clock_jumps_to_what_waits_and_one_that_is_held_stands_still() {
        let clock = Clock::simulated();
        let start = clock.now();
        clock.sleep(3600 * 1000 * MS);
        assert_eq!(clock.since(start), 3600 * 1000 * MS);
        clock.hold();
        let then = clock.now();
        assert_eq!(clock.now(), then);
        clock.advance(5 * MS);
        assert_eq!(clock.since(then), 5 * MS);
        assert_eq!(
            clock.since(then + 6 * MS),
            Duration::ZERO,
            "no time is negative"
        );
    }

    #[test]
    fn each_sleeper_wakes_at_its_own_time_and_its_work_is_done_when_the_time_has_passed() {
        let clock = Clock::simulated();
        clock.hold();
        let start = clock.now();
        let counts = [3, 7].map(|_| AtomicU32::new(0));
        thread::scope(|scope| {
            for (period, count) in [3, 7].into_iter().zip(&counts) {
                let sleeper = clock.sleeper();
                scope.spawn(move || {
                    for turn in 1..=100 {
                        let due = start + turn * period * MS;
                        sleeper.sleep_until(due);
                        assert!(sleeper.clock().now() >= due);
                        count.fetch_add(1, Ordering::SeqCst);
                    }
                });
            }
            for (ms, expected) in [(2, [0, 0]), (1, [1, 0]), (4, [2, 1]), (14, [7, 3])] {
                clock.advance(ms * MS);
                let seen = [0, 1].map(|index| counts[index].load(Ordering::SeqCst));
                assert_eq!(seen, expected, "{:?}", clock.since(start));
            }
            assert_eq!(clock.since(start), 21 * MS);
            clock.release();
        });
        assert!(
            counts
                .iter()
                .all(|count| count.load(Ordering::SeqCst) == 100)
        );
    }

    #[test]
    fn a_sleeper_that_has_ended_keeps_nobody_waiting() {
        let clock = Clock::simulated();
        clock.hold();
        let sleeper = clock.sleeper();
        let ended = thread::spawn(move || drop(sleeper));
        clock.advance(MS);
        ended.join().unwrap();
    }

    #[test]
    fn the_machines_time_passes_by_itself() {
        let clock = Clock::real();
        let start = clock.now();
        clock.hold();
        clock.sleep(MS);
        clock.advance(MS);
        assert!(clock.since(start) >= 2 * MS);
    }
}
