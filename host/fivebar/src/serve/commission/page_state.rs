//! The state of a commissioning, as pages get it.

use crate::commission::{Commissioning, Done};
use fivebar_sim::clock::Clock;
use serde::Serialize;
use std::time::{Duration, Instant};

/// No step begins for this time after the end of a stop, so that quick clicks do not go on to move the arm.
pub(super) const PAUSE: Duration = Duration::from_secs(1);

/// A step on the page.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ShownStep {
    name: &'static str,
    does: &'static str,
    /// What was found and when, once done.
    found: Option<String>,
    date: Option<String>,
    /// The sign before it.
    sign: Option<&'static str>,
}

/// A task that waits for a person.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ShownTask {
    pub(super) text: String,
    /// The simulated operator can do it.
    pub(super) simulated: bool,
    /// Those among which a person chooses; none if the task is only to be done.
    pub(super) answers: Vec<String>,
}

/// The state, as pages get it.
#[derive(Clone, Debug, Default, Serialize)]
pub(in crate::serve) struct PageState {
    pub(super) steps: Vec<ShownStep>,
    /// The first step that is not done.
    pub(super) next: Option<&'static str>,
    /// The step that is being done.
    pub(super) running: Option<&'static str>,
    pub(super) task: Option<ShownTask>,
    /// What the step has told.
    pub(super) lines: Vec<String>,
    /// What is wrong and what to do about it, of the last step.
    pub(super) trouble: Option<String>,
    /// Where record and robot file are.
    pub(super) place: String,
    /// Stops that have switched the bridges off.
    pub(super) stops: u32,
    /// No step begins until a person has said that the arm is safe.
    pub(super) stopped: bool,
    /// When that was said.
    #[serde(skip)]
    pub(super) released: Option<Instant>,
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
        self.steps = commissioning
            .steps()
            .iter()
            .map(|step| {
                let done = commissioning.done(step.name);
                ShownStep {
                    name: step.name,
                    does: step.does,
                    found: done.map(|done| done.found.clone()),
                    date: done.map(|done| done.date.clone()),
                    sign: done.map(Done::sign),
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

    /// Whether a step may begin now.
    pub(super) fn may_begin(&self, clock: &Clock) -> Result<(), &'static str> {
        if self.running.is_some() {
            return Err("a step is being done\n");
        }
        if self.stopped {
            return Err("the arm was stopped: say first that it is safe\n");
        }
        if self.released.is_some_and(|at| clock.since(at) < PAUSE) {
            return Err("the arm was stopped: look at it, wait a second, then start the step\n");
        }
        Ok(())
    }

    /// The step has ended.
    pub(super) fn end(&mut self, outcome: Result<(), String>) {
        self.running = None;
        self.task = None;
        self.trouble = outcome.err();
    }

    /// A task waits, or a question with these answers.
    pub(super) fn ask(&mut self, text: &str, simulated: bool, answers: &[String]) {
        self.task = Some(ShownTask {
            text: text.into(),
            simulated,
            answers: answers.to_vec(),
        });
    }

    /// It was done.
    pub(super) fn answer(&mut self, hand_does_all: bool) {
        self.task = None;
        self.hand_does_all = hand_does_all;
    }
}
