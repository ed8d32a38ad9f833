//! What pages show of a commissioning.

use super::super::message::ServerMessage;
use super::super::stop_signal::Stop;
use super::super::updates::Updates;
use super::clicks::Click;
use crate::commission::{Commissioning, STEPS};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Lines of the step that are kept.
const LINES: usize = 200;
/// No step begins for this time after the end of a stop, so that quick clicks do not go on to move the arm.
const PAUSE: Duration = Duration::from_secs(1);

/// A step on the page.
#[derive(Clone, Debug, Serialize)]
struct ShownStep {
    name: &'static str,
    does: &'static str,
    /// What was found and when, once done.
    found: Option<String>,
    date: Option<String>,
}

/// A task that waits for a person.
#[derive(Clone, Debug, Serialize)]
struct ShownTask {
    text: String,
    /// The simulated operator can do it.
    simulated: bool,
}

/// The state, as pages get it.
#[derive(Clone, Debug, Default, Serialize)]
pub(in crate::serve) struct PageState {
    steps: Vec<ShownStep>,
    /// The first step that is not done.
    next: Option<&'static str>,
    /// The step that is being done.
    running: Option<&'static str>,
    task: Option<ShownTask>,
    /// What the step has told.
    pub(super) lines: Vec<String>,
    /// What is wrong and what to do about it, of the last step.
    pub(super) trouble: Option<String>,
    /// Where record and robot file are.
    place: String,
    /// Stops that have switched the bridges off.
    pub(super) stops: u32,
    /// No step begins until a person has said that the arm is safe.
    pub(super) stopped: bool,
    /// When that was said.
    #[serde(skip)]
    released: Option<Instant>,
    #[serde(skip)]
    pub(super) hand_does_all: bool,
}

impl PageState {
    pub(super) fn new(commissioning: &Commissioning) -> Self {
        let mut state = Self::default();
        state.show_steps(commissioning);
        state
    }

    /// Shows which steps are done.
    pub(super) fn show_steps(&mut self, commissioning: &Commissioning) {
        self.steps = STEPS
            .iter()
            .map(|step| {
                let done = commissioning.done(step.name);
                ShownStep {
                    name: step.name,
                    does: step.does,
                    found: done.map(|done| done.found.clone()),
                    date: done.map(|done| done.date.clone()),
                }
            })
            .collect();
        self.next = commissioning.next().map(|step| step.name);
        self.place = commissioning.files();
    }

    /// A step begins.
    pub(super) fn begin(&mut self, step: &'static str) {
        self.running = Some(step);
        self.lines.clear();
        self.trouble = None;
        self.hand_does_all = false;
    }

    /// Whether a step may begin.
    fn may_begin(&self) -> Result<(), &'static str> {
        if self.running.is_some() {
            return Err("a step is being done\n");
        }
        if self.stopped {
            return Err("the arm was stopped: say first that it is safe\n");
        }
        if self.released.is_some_and(|at| at.elapsed() < PAUSE) {
            return Err("the arm was stopped: look at it, wait a second, then start the step\n");
        }
        Ok(())
    }

    /// The step has ended.
    pub(super) fn end(&mut self, outcome: Result<String, String>) {
        self.running = None;
        self.task = None;
        self.trouble = outcome.err();
    }

    /// A task waits.
    pub(super) fn ask(&mut self, text: &str, simulated: bool) {
        let text = text.into();
        self.task = Some(ShownTask { text, simulated });
    }

    /// It was done.
    pub(super) fn answer(&mut self, hand_does_all: bool) {
        self.task = None;
        self.hand_does_all = hand_does_all;
    }
}

/// What pages and the thread of the steps share.
pub(super) struct Shared {
    state: Mutex<PageState>,
    clicks: Sender<Click>,
    updates: Updates,
    /// A stop that has not switched the bridges off yet.
    pub(super) stop: Arc<AtomicBool>,
    /// The program ends.
    ended: AtomicBool,
}

impl Shared {
    pub(super) fn new(clicks: Sender<Click>, updates: Updates) -> Self {
        Self {
            state: Mutex::default(),
            clicks,
            updates,
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
            state.released = Some(Instant::now());
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
            Click::Begin(_) => state.may_begin()?,
            Click::Done { .. } if state.task.is_none() => return Err("no task waits\n"),
            Click::Again(_) | Click::Done { .. } => {}
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
