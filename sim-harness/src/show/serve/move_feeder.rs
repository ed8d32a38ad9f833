//! What the controller is to be given next: a job move by move, or the latest aim.

use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, MoveKind, Status};

/// The moves that wait for the controller to have room.
#[derive(Debug, Default)]
pub(super) struct MoveFeeder {
    /// The running job and how many of its moves have been taken.
    job: Option<(Vec<Move>, usize)>,
    /// Where to go as soon as the queue is nearly empty.
    aim: Option<MoveKind>,
    /// Where the queue ends; none: where the arm is held.
    end: Option<End>,
    /// Room of the controller's empty queue.
    empty: u8,
    /// The tick since which the controller has had nothing to do.
    idle_since: Option<u32>,
}

/// Where a move ends, as it was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// The tool [m].
    Tool([f32; 2]),
    /// θ1, θ4 [rad].
    Joints([f32; 2]),
}

impl End {
    /// The end of a move; none for one that goes nowhere.
    fn of(kind: &MoveKind) -> Option<Self> {
        match *kind {
            MoveKind::Line { to, .. } | MoveKind::Arc { to, .. } => Some(Self::Tool(to)),
            MoveKind::Joint { to, .. } => Some(Self::Joints(to)),
            MoveKind::Dwell { .. } => None,
        }
    }
}

/// What a look at the controller has brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    /// Nothing to tell.
    Quiet,
    /// The job has come to its end.
    Finished,
    /// The controller takes no moves any more: the rest of the job is forgotten.
    Abandoned,
}

impl MoveFeeder {
    pub(super) fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Moves of the job that have been taken, and all.
    pub(super) fn progress(&self) -> Option<[usize; 2]> {
        let (moves, taken) = self.job.as_ref()?;
        Some([*taken, moves.len()])
    }

    /// Begins a job.
    pub(super) fn run(&mut self, moves: Vec<Move>) {
        self.aim = None;
        self.job = Some((moves, 0));
    }

    /// Takes the place of an aim not yet given to the controller.
    pub(super) fn aim_at(&mut self, aim: MoveKind) {
        self.aim = Some(aim);
    }

    /// Where the next move begins; none: where the arm is held.
    pub(super) fn end(&self) -> Option<End> {
        self.aim.as_ref().and_then(End::of).or(self.end)
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.job = None;
        self.aim = None;
        self.end = None;
    }

    /// Looks at the controller, which has room for so many moves.
    pub(super) fn look(&mut self, status: &Status, room: u8) -> Turn {
        self.empty = self.empty.max(room);
        if !takes_moves(status.state) {
            let abandoned = self.is_running();
            self.clear();
            return if abandoned {
                Turn::Abandoned
            } else {
                Turn::Quiet
            };
        }
        if !self.is_idle(status, room) {
            return Turn::Quiet;
        }
        self.end = None;
        match &self.job {
            Some((moves, taken)) if *taken == moves.len() => {
                self.job = None;
                Turn::Finished
            }
            _ => Turn::Quiet,
        }
    }

    /// Whether all moves are done. Between two ticks a queue may be empty and its last
    /// piece not begun, so that takes two looks.
    fn is_idle(&mut self, status: &Status, room: u8) -> bool {
        if status.state != State::Armed || room != self.empty {
            self.idle_since = None;
            return false;
        }
        *self.idle_since.get_or_insert(status.tick) != status.tick
    }

    /// The move to be given now, if there is one.
    pub(super) fn next(&self, room: u8) -> Option<Move> {
        if let Some((moves, taken)) = &self.job {
            return moves.get(*taken).filter(|_| room > 0).copied();
        }
        // An aim waits until hardly anything is before it, so that the latest counts.
        let kind = self.aim.filter(|_| room + 1 >= self.empty)?;
        Some(Move { tag: 0, kind })
    }

    /// The controller has taken that move.
    pub(super) fn taken(&mut self, order: &Move) {
        match &mut self.job {
            Some((_, taken)) => *taken += 1,
            None => self.aim = None,
        }
        self.end = End::of(&order.kind).or(self.end);
        self.idle_since = None;
    }

    /// The controller has refused it.
    pub(super) fn refused(&mut self) {
        self.job = None;
        self.aim = None;
    }
}

/// Whether a controller in this state takes moves.
pub(super) fn takes_moves(state: State) -> bool {
    matches!(state, State::Armed | State::Running)
}
