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
    /// The answer of this index to the question that waits.
    Answer(usize),
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
        self.wait(task, simulated, &[], |click| match click {
            Click::Done { all } => Some(all && simulated),
            _ => None,
        })
        .map(|all| self.shared.change(|state| state.answer(all)))
    }

    fn choose(&mut self, question: &str, answers: &[String]) -> Result<usize, StepError> {
        let chosen = self.wait(question, false, answers, |click| match click {
            Click::Answer(index) if index < answers.len() => Some(index),
            _ => None,
        })?;
        self.shared.change(|state| state.answer(false));
        Ok(chosen)
    }
}

impl PageOutput {
    /// Shows a task until a click does it; what that click says.
    fn wait<T>(
        &self,
        task: &str,
        simulated: bool,
        answers: &[String],
        does_it: impl Fn(Click) -> Option<T>,
    ) -> Result<T, StepError> {
        let clicked = self.clicked.lock().unwrap_or_else(PoisonError::into_inner);
        // A second click on the task before does not answer this one.
        while clicked.try_recv().is_ok() {}
        self.shared
            .change(|state| state.ask(task, simulated, answers));
        loop {
            if self.shared.is_stopped() {
                return Err(StepError::other("stopped"));
            }
            match clicked.recv_timeout(LOOK) {
                Ok(click) => {
                    if let Some(done) = does_it(click) {
                        return Ok(done);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(StepError::other("the page's server has ended"));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Click, Output, PageOutput};
    use crate::serve::commission::state::Shared;
    use crate::serve::wire::channels::channels;
    use crate::serve::wire::updates::Updates;
    use fivebar_sim::clock::Clock;
    use std::sync::mpsc::channel;
    use std::sync::{Arc, Mutex};
    use std::thread;

    #[test]
    fn a_question_shows_its_answers_and_only_one_of_these_ends_it() {
        let clock = Clock::simulated();
        let (clicks, clicked) = channel();
        let (_web, _controller, pages) = channels(clock.clone());
        let shared = Arc::new(Shared::new(clicks, Updates::start(pages), clock));
        let mut output = PageOutput::new(Arc::clone(&shared), Arc::new(Mutex::new(clicked)));
        let answers = ["it turned", "it is held"].map(String::from);
        let offered = answers.clone();
        let asked = thread::spawn(move || output.choose("What do you feel?", &offered).ok());
        while shared.read(|state| state.task.is_none()) {
            thread::yield_now();
        }
        assert_eq!(
            shared.read(|state| state.task.clone().map(|task| task.answers)),
            Some(answers.to_vec())
        );
        for click in [
            Click::Done { all: true },
            Click::Answer(2),
            Click::Answer(1),
        ] {
            assert_eq!(shared.click(click), Ok(()));
        }
        assert_eq!(asked.join().ok().flatten(), Some(1));
        assert!(shared.read(|state| state.task.is_none()));
    }
}
