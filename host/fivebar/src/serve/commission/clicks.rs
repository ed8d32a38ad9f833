//! What pages click, and the output that asks them for tasks.

use super::state::Shared;
use crate::commission::{Output, StepError};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How often a wait for a click looks for a stop.
const LOOK: Duration = Duration::from_millis(20);

/// A click on a page.
#[derive(Debug)]
pub(super) enum Click {
    /// Begin this step.
    Begin(&'static str),
    /// Forget this step and those after it.
    Again(&'static str),
    /// The task is done; `all`: the simulated operator does the other tasks of the step, too.
    Done { all: bool },
}

/// Shows lines on pages and asks them for tasks.
pub(super) struct PageOutput {
    shared: Arc<Shared>,
    clicked: Arc<Mutex<Receiver<Click>>>,
}

impl PageOutput {
    pub(super) fn new(shared: Arc<Shared>, clicked: Arc<Mutex<Receiver<Click>>>) -> Self {
        Self { shared, clicked }
    }
}

impl Output for PageOutput {
    fn report(&mut self, line: &str) -> Result<(), StepError> {
        self.shared.change(|state| state.lines.push(line.into()));
        Ok(())
    }

    fn ask(&mut self, task: &str, simulated: bool) -> Result<(), StepError> {
        if simulated && self.shared.read(|state| state.hand_does_all) {
            return Ok(());
        }
        let clicked = self.clicked.lock().unwrap_or_else(PoisonError::into_inner);
        // A second click on the task before does not answer this one.
        while clicked.try_recv().is_ok() {}
        self.shared.change(|state| state.ask(task, simulated));
        loop {
            if self.shared.is_stopped() {
                return Err(StepError::other("stopped"));
            }
            match clicked.recv_timeout(LOOK) {
                Ok(Click::Done { all }) => {
                    self.shared.change(|state| state.answer(all && simulated));
                    return Ok(());
                }
                Ok(Click::Begin(_) | Click::Again(_)) | Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(StepError::other("the page's server has ended"));
                }
            }
        }
    }
}
