//! What the thread of an arm and those who call it tell each other.

use super::LiveError;
use fivebar_firmware::Status;
use fivebar_firmware::protocol::StreamState;
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// What is known of the arm.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Its latest status.
    pub status: Status,
    /// How many moves of the present call the controller has taken.
    pub taken: usize,
    /// How many it has.
    pub moves: usize,
    /// What the job waits for, at a pause.
    pub pause: Option<String>,
    /// What the controller has told last of the latest stream.
    pub stream: Option<StreamState>,
}

/// What the thread and the callers share.
pub(super) struct Shared {
    state: Mutex<State>,
    /// A call has ended.
    ended: Condvar,
}

struct State {
    progress: Progress,
    is_busy: bool,
    wants_stop: bool,
    goes_on: bool,
    /// Those who ask for an emergency stop.
    emergencies: Vec<Sender<()>>,
    /// Why the thread has ended.
    failure: Option<String>,
}

/// A call is being done; it ends when this is dropped.
pub(super) struct Busy(Arc<Shared>);

impl Drop for Busy {
    fn drop(&mut self) {
        let mut state = self.0.state();
        state.is_busy = false;
        state.wants_stop = false;
        state.goes_on = false;
        state.progress.pause = None;
        self.0.ended.notify_all();
    }
}

impl Shared {
    pub(super) fn new(status: Status) -> Self {
        let progress = Progress {
            status,
            taken: 0,
            moves: 0,
            pause: None,
            stream: None,
        };
        Self {
            state: Mutex::new(State {
                progress,
                is_busy: false,
                wants_stop: false,
                goes_on: false,
                emergencies: Vec::new(),
                failure: None,
            }),
            ended: Condvar::new(),
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a call.
    pub(super) fn begin(self: &Arc<Self>) -> Result<Busy, LiveError> {
        let mut state = self.state();
        if state.is_busy {
            return Err(LiveError::Busy);
        }
        state.is_busy = true;
        (state.progress.taken, state.progress.moves) = (0, 0);
        drop(state);
        Ok(Busy(self.clone()))
    }

    pub(super) fn progress(&self) -> Progress {
        self.state().progress.clone()
    }

    /// The controller has this status.
    pub(super) fn note(&self, status: &Status) {
        self.state().progress.status = *status;
    }

    /// The controller has told this of a stream.
    pub(super) fn note_stream(&self, state: &StreamState) {
        self.state().progress.stream = Some(*state);
    }

    /// The controller has taken so many of so many moves.
    pub(super) fn note_moves(&self, taken: usize, moves: usize) {
        let progress = &mut self.state().progress;
        (progress.taken, progress.moves) = (taken, moves);
    }

    /// The job waits at a pause; returns whether it goes on.
    pub(super) fn waits_at(&self, text: &str) -> bool {
        let mut state = self.state();
        let goes_on = std::mem::take(&mut state.goes_on);
        state.progress.pause = (!goes_on).then(|| text.into());
        goes_on
    }

    pub(super) fn go_on(&self) {
        let mut state = self.state();
        state.goes_on = state.progress.pause.is_some();
    }

    pub(super) fn wants_stop(&self) -> bool {
        self.state().wants_stop
    }

    /// Asks the present call to stop and waits for its end.
    pub(super) fn stop(&self) {
        let mut state = self.state();
        state.wants_stop = state.is_busy;
        while state.is_busy {
            let ended = self.ended.wait(state);
            state = ended.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Asks for an emergency stop; the receiver learns that the controller has it.
    pub(super) fn ask_for_emergency_stop(&self) -> Receiver<()> {
        let (done, waits) = mpsc::channel();
        let mut state = self.state();
        if state.failure.is_none() {
            state.emergencies.push(done);
        }
        waits
    }

    /// Those who ask for an emergency stop now.
    pub(super) fn emergencies(&self) -> Vec<Sender<()>> {
        std::mem::take(&mut self.state().emergencies)
    }

    /// Whether the present call should end, or power is to be switched off at once.
    pub(super) fn is_interrupted(&self) -> bool {
        let state = self.state();
        state.wants_stop || !state.emergencies.is_empty()
    }

    /// Why the thread ends.
    pub(super) fn note_failure(&self, failure: String) {
        self.state().failure = Some(failure);
    }

    /// The thread has ended: no one waits for an emergency stop any longer.
    pub(super) fn note_end(&self) {
        let mut state = self.state();
        state.failure.get_or_insert_default();
        state.emergencies.clear();
    }

    /// That the connection has ended, and why.
    pub(super) fn ended(&self) -> LiveError {
        let failure = self.state().failure.clone();
        LiveError::Ended(failure.unwrap_or_default())
    }
}
