//! What pages show of a commissioning.

use super::super::wire::message::ServerMessage;
use super::super::wire::stop_signal::Stop;
use super::super::wire::updates::Updates;
use super::clicks::Click;
use super::page_state::PageState;
use fivebar_sim::clock::Clock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Lines of the step that are kept.
const LINES: usize = 200;
/// What pages and the thread of the steps share.
pub(super) struct Shared {
    state: Mutex<PageState>,
    clicks: Sender<Click>,
    updates: Updates,
    pub(super) clock: Clock,
    /// A stop that has not switched the bridges off yet.
    pub(super) stop: Arc<AtomicBool>,
    /// The program ends.
    ended: AtomicBool,
}

impl Shared {
    pub(super) fn new(clicks: Sender<Click>, updates: Updates, clock: Clock) -> Self {
        Self {
            state: Mutex::default(),
            clicks,
            updates,
            clock,
            stop: Arc::default(),
            ended: AtomicBool::new(false),
        }
    }

    fn state(&self) -> MutexGuard<'_, PageState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads the state.
    pub(super) fn read<T>(&self, read: impl FnOnce(&PageState) -> T) -> T {
        read(&self.state())
    }

    /// Changes the state and shows it to the pages.
    pub(super) fn change(&self, change: impl FnOnce(&mut PageState)) {
        let mut state = self.state();
        change(&mut state);
        let surplus = state.lines.len().saturating_sub(LINES);
        state.lines.drain(..surplus);
        self.updates.send(&ServerMessage::Guide(&state));
    }

    /// A person says that the arm is safe after a stop.
    pub(super) fn release(&self) {
        self.change(|state| {
            state.stopped = false;
            state.trouble = None;
            state.released = Some(self.clock.now());
        });
    }

    /// The state as JSON.
    pub(super) fn json(&self) -> String {
        self.read(|state| serde_json::to_string(state).unwrap_or_default())
    }

    /// Passes a click on, if it belongs to what is shown.
    pub(super) fn click(&self, click: Click) -> Result<(), &'static str> {
        let mut state = self.state();
        match &click {
            Click::Again(_) if state.running.is_some() => return Err("a step is being done\n"),
            Click::Begin(_) if self.is_stopped() => return Err("the arm is being stopped\n"),
            Click::Begin(_) => state.may_begin(&self.clock)?,
            Click::Done { .. } | Click::Answer(_) if state.task.is_none() => {
                return Err("no task waits\n");
            }
            Click::Again(_) | Click::Done { .. } | Click::Answer(_) => {}
        }
        if let Click::Begin(step) = &click {
            // From now on, so that a second click is refused.
            state.begin(step);
            self.updates.send(&ServerMessage::Guide(&state));
        }
        // Under the lock, so that whoever forgets the clicks and shows a state forgets this one, too.
        self.clicks
            .send(click)
            .map_err(|_| "the program has ended\n")
    }

    /// A page stops the arm.
    pub(super) fn raise_stop(&self) {
        self.stop.store(true, Ordering::Release);
    }

    /// A stop has switched the bridges off.
    pub(super) fn confirm_stop(&self) {
        self.updates.send(&ServerMessage::Stopped(Stop::Emergency));
    }

    /// The program ends: stops the arm.
    pub(super) fn end(&self) {
        self.ended.store(true, Ordering::Release);
        self.raise_stop();
    }

    /// Whether the program ends.
    pub(super) fn has_ended(&self) -> bool {
        self.ended.load(Ordering::Acquire)
    }

    /// Whether a stop waits to be done.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }
}

#[cfg(test)]
mod tests {
    use super::super::clicks::Click;
    use super::Shared;
    use crate::serve::commission::page_state::PAUSE;
    use crate::serve::wire::channels::channels;
    use crate::serve::wire::updates::Updates;
    use fivebar_sim::clock::Clock;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    #[test]
    fn no_step_begins_before_a_second_has_passed_since_a_person_has_said_that_the_arm_is_safe() {
        let clock = Clock::simulated();
        let (clicks, _clicked) = channel();
        let (_web, _controller, pages) = channels(clock.clone());
        let shared = Shared::new(clicks, Updates::start(pages), clock.clone());
        shared.change(|state| state.stopped = true);
        let refusal = || shared.click(Click::Begin("supply")).err();
        assert!(refusal().is_some_and(|why| why.contains("say first that it is safe")));
        shared.release();
        for passed in [Duration::ZERO, PAUSE - Duration::from_millis(1)] {
            clock.sleep(passed);
            assert!(refusal().is_some_and(|why| why.contains("wait a second")));
        }
        clock.sleep(Duration::from_millis(1));
        assert_eq!(refusal(), None);
    }
}
