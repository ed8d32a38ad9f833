//! The moves that wait for the controller: a job, or the latest target.

use super::job_thread::ParsedJob;
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, MoveKind, Status};
use std::sync::Arc;

/// Gives the controller a move whenever its queue has room.
#[derive(Default)]
pub(super) struct MoveFeeder {
    /// The running job, and how many of its moves the controller has accepted.
    job: Option<(Arc<ParsedJob>, usize)>,
    /// The next target; it is sent as soon as the queue is nearly empty.
    target: Option<MoveKind>,
    /// The end of the last accepted move; none: the arm's present reference.
    end: Option<MoveEnd>,
    /// How many moves the controller's empty queue takes.
    empty: u8,
    /// The tick since which the controller has had no moves.
    idle_since: Option<u32>,
}

/// The end of a move, as it was requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MoveEnd {
    /// The tool's position [m].
    Tool([f32; 2]),
    /// θ1, θ4 [rad].
    Joints([f32; 2]),
}

impl MoveEnd {
    /// The end of a move; none for a dwell.
    fn of(kind: &MoveKind) -> Option<Self> {
        match *kind {
            MoveKind::Line { to, .. } | MoveKind::Arc { to, .. } => Some(Self::Tool(to)),
            MoveKind::Joint { to, .. } => Some(Self::Joints(to)),
            MoveKind::Dwell { .. } => None,
        }
    }
}

/// How the job has changed since the last update.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JobStatus {
    /// The job continues, or there is none.
    Unchanged,
    /// The job is done.
    Finished,
    /// The controller no longer accepts moves: the rest of the job is cancelled.
    Cancelled,
}

impl MoveFeeder {
    pub(super) fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Accepted moves of the job, and all its moves.
    pub(super) fn progress(&self) -> Option<[usize; 2]> {
        let (job, taken) = self.job.as_ref()?;
        Some([*taken, job.moves.len()])
    }

    /// Starts a job.
    pub(super) fn run(&mut self, job: Arc<ParsedJob>) {
        self.target = None;
        self.job = Some((job, 0));
    }

    /// Replaces a target that the controller has not accepted yet.
    pub(super) fn set_target(&mut self, target: MoveKind) {
        self.target = Some(target);
    }

    /// The point at which the next move begins; none: the arm's present reference.
    pub(super) fn end(&self) -> Option<MoveEnd> {
        self.target.as_ref().and_then(MoveEnd::of).or(self.end)
    }

    /// Removes job and target.
    pub(super) fn clear(&mut self) {
        self.job = None;
        self.target = None;
        self.end = None;
    }

    /// Updates the job from the controller's status and its room for further moves.
    pub(super) fn update(&mut self, status: &Status, room: u8) -> JobStatus {
        self.empty = self.empty.max(room);
        if !takes_moves(status.state) {
            let abandoned = self.is_running();
            self.clear();
            return if abandoned {
                JobStatus::Cancelled
            } else {
                JobStatus::Unchanged
            };
        }
        if !self.is_idle(status, room) {
            return JobStatus::Unchanged;
        }
        self.end = None;
        match &self.job {
            Some((job, taken)) if *taken == job.moves.len() => {
                self.job = None;
                JobStatus::Finished
            }
            _ => JobStatus::Unchanged,
        }
    }

    /// Whether all moves are done. Between two ticks a queue may be empty although its
    /// last segment has not begun, so the moves are done if this holds in two different ticks.
    fn is_idle(&mut self, status: &Status, room: u8) -> bool {
        if status.state != State::Armed || room != self.empty {
            self.idle_since = None;
            return false;
        }
        *self.idle_since.get_or_insert(status.tick) != status.tick
    }

    /// The move to send now, if there is one.
    pub(super) fn next(&self, room: u8) -> Option<Move> {
        if let Some((job, taken)) = &self.job {
            return job.moves.get(*taken).filter(|_| room > 0).copied();
        }
        // A target waits until the queue is nearly empty, so that the latest one is sent.
        let kind = self.target.filter(|_| room + 1 >= self.empty)?;
        Some(Move {
            tag: 0,
            tool: 0,
            kind,
        })
    }

    /// Records that the controller has accepted the move.
    pub(super) fn taken(&mut self, next: &Move) {
        match &mut self.job {
            Some((_, taken)) => *taken += 1,
            None => self.target = None,
        }
        self.end = MoveEnd::of(&next.kind).or(self.end);
        self.idle_since = None;
    }

    /// Records that the controller has refused the move: job and target end.
    pub(super) fn refused(&mut self) {
        self.job = None;
        self.target = None;
    }
}

/// Whether a controller in this state accepts moves.
pub(super) fn takes_moves(state: State) -> bool {
    matches!(state, State::Armed | State::Running)
}
