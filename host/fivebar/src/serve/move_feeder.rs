//! The moves that wait for the controller: a job, or the latest target.

use super::parsed_job::ParsedJob;
use fivebar_firmware::safety::State;
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Status};
use fivebar_sim::path_queue::{PathQueue, Shares};
use std::collections::VecDeque;
use std::sync::Arc;

/// Moves of the job that wait in the queue.
const WAITING: usize = 4;
/// Time of a job after which its pace at another share of the feed rates is known [s].
const MEASURED: f64 = 1.0;

/// Rest in which a page's pen moves [s]; the planner adds the time of a servo.
const PEN_TIME: f32 = 1e-3;

/// Gives the controller a move whenever its queue has room.
#[derive(Default)]
pub(super) struct MoveFeeder {
    /// The running job, or one that was stopped and keeps its place.
    job: Option<RunningJob>,
    /// Its moves on their way. Their own tags are their numbers in the job, from 1.
    path: PathQueue,
    /// The moves to the next target; they are sent as soon as the queue is nearly empty.
    target: VecDeque<Move>,
    /// The end of the last accepted target; none: the arm's present reference.
    end: Option<MoveEnd>,
    /// How many moves the controller's empty queue takes.
    empty: u8,
    /// The tick since which the controller has had no moves.
    idle_since: Option<u32>,
}

/// A job and how much of it is on its way.
struct RunningJob {
    job: Arc<ParsedJob>,
    /// The number of its moves that were put on their way.
    sent: usize,
    /// The number of its moves up to the next pause, or to its end.
    until: usize,
    /// The pause at which it waits for its user.
    pause: Option<String>,
    phase: JobPhase,
    /// Where the tool should have been when the job was last seen to go on [m].
    place: Option<[f32; 2]>,
    /// The tick in which it began or went on, and the time of the job that had passed [s].
    begun: Option<(u32, f64)>,
    /// The tick in which it was last seen to go on.
    seen: u32,
    /// The number of moves before the present one, and the tick in which that one was first seen.
    present: (usize, u32),
    /// The arm when it was last seen to go on outside of a crossing.
    arm: Option<Status>,
}

/// What happens to a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum JobPhase {
    /// It runs.
    Fed,
    /// The controller follows the moves that it has and gets no more.
    Left,
    /// It is stopped while the arm crosses: its place is where the crossing ends.
    Crossing,
    /// It rests, or comes to rest, at its place.
    Held,
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
            MoveKind::Timed(timed) => Some(Self::Tool(timed.end())),
            MoveKind::Crossing(plan) => Some(Self::Tool(plan.to)),
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
    /// The controller no longer accepts moves: the job waits at its place.
    Held,
    /// The arm rests where the job waits for its user.
    Paused,
}

impl RunningJob {
    /// The job from its piece with this index on.
    fn new(job: Arc<ParsedJob>, index: usize) -> Self {
        Self {
            until: until(&job, index),
            job,
            sent: index,
            pause: None,
            phase: JobPhase::Fed,
            place: None,
            begun: None,
            seen: 0,
            present: (index, 0),
            arm: None,
        }
    }

    /// The number of moves before the present one; an approach to the job has tag 0, and is before all of them.
    fn number(&self, present: Option<u32>) -> usize {
        present.map_or(self.sent, |tag| tag.saturating_sub(1) as usize)
    }

    /// Holds at the pause where all moves up to it are done; the next moves are those behind it.
    fn hold_at_pause(&mut self) {
        self.phase = JobPhase::Held;
        let before = self.sent - 1;
        let pause = self.job.next_pause(before);
        self.pause = pause.map(|(_, text)| text.into());
        self.until = until(&self.job, self.sent);
    }
}

/// The number of a job's moves up to the first pause behind this many, or to its end.
fn until(job: &ParsedJob, sent: usize) -> usize {
    let pause = job.next_pause(sent);
    pause.map_or(job.pieces.len(), |(before, _)| before)
}

impl MoveFeeder {
    pub(super) fn is_running(&self) -> bool {
        let job = self.job.as_ref();
        job.is_some_and(|job| job.phase == JobPhase::Fed)
    }

    /// The line of the job at which it goes on; none if no job was begun.
    pub(super) fn line(&self) -> Option<u32> {
        let run = self.job.as_ref()?;
        let number = self.path.present().map_or(run.sent, |tag| tag as usize);
        Some(run.job.pieces.get(number.saturating_sub(1))?.tag)
    }

    /// The job that was stopped, the place at which it goes on [m], and the arm on the branch on which
    /// it does.
    pub(super) fn held(&self) -> Option<(&Arc<ParsedJob>, [f32; 2], &Status)> {
        let run = self.job.as_ref()?;
        (run.phase != JobPhase::Fed).then_some((&run.job, run.place?, run.arm.as_ref()?))
    }

    /// The pause at which the job waits for its user.
    pub(super) fn pause(&self) -> Option<&str> {
        self.job.as_ref()?.pause.as_deref()
    }

    /// The part of the job at which it goes on; none if no job was begun.
    pub(super) fn part(&self) -> Option<usize> {
        let run = self.job.as_ref()?;
        let number = run.number(self.path.present());
        Some(run.job.part(number))
    }

    /// The time of the job that has passed, and its whole time, by its plan [s].
    pub(super) fn progress(&self, tick_rate: f64) -> Option<[f64; 2]> {
        let run = self.job.as_ref()?;
        let number = run.number(self.path.present());
        let times = &run.job.times;
        let before = number.checked_sub(1).map_or(0.0, |last| times[last]);
        let whole = *times.last()?;
        let end = times.get(number).copied().unwrap_or(whole);
        let (of, since) = run.present;
        let in_present = match of == number {
            true => f64::from(run.seen.wrapping_sub(since)) / tick_rate * f64::from(self.feed()),
            false => 0.0,
        };
        let done = run.job.done;
        Some([done + end.min(before + in_present), done + whole])
    }

    /// The time that the running job still takes [s]: by its plan; at another share of its feed rates longer or
    /// shorter by as much as it was since the share was chosen.
    pub(super) fn left(&self, tick_rate: f64) -> Option<f64> {
        let run = self.job.as_ref().filter(|_| self.is_running())?;
        let [passed, all] = self.progress(tick_rate)?;
        let mut longer = 1.0 / f64::from(self.feed());
        if let Some((tick, before)) = run.begun.filter(|(_, before)| passed - before > MEASURED)
            && !(run.job.is_timed && self.feed() == 1.0)
        {
            let took = f64::from(run.seen.wrapping_sub(tick)) / tick_rate;
            longer = took / (passed - before);
        }
        Some((all - passed) * longer)
    }

    /// Gives the job its times, which are planned while it may run.
    pub(super) fn set_times(&mut self, timed: &Arc<ParsedJob>) {
        if let Some(run) = &mut self.job
            && Arc::ptr_eq(&run.job.pieces, &timed.pieces)
        {
            run.job = Arc::clone(timed);
            run.begun = None;
        }
    }

    /// Chooses the share of the job's feed rates.
    pub(super) fn set_feed(&mut self, share: f32) {
        let shares = self.path.shares();
        self.path.set_shares(Shares {
            feed: share,
            ..shares
        });
        if let Some(run) = &mut self.job {
            run.begun = None;
        }
    }

    /// The share of the job's feed rates.
    pub(super) fn feed(&self) -> f32 {
        self.path.shares().feed
    }

    /// Starts a job at the move with this index. `approach` leads to its start with the tool up.
    pub(super) fn run(&mut self, job: Arc<ParsedJob>, index: usize, approach: Option<MoveKind>) {
        self.target.clear();
        self.path.clear();
        if let Some(kind) = approach {
            let tag = index as u32 + 1;
            self.path.push(&[Move { tag, tool: 0, kind }]);
        }
        self.job = Some(RunningJob::new(job, index));
        self.fill();
    }

    /// Goes on with the job that was stopped. `approach` leads to its place with the tool up.
    pub(super) fn resume(&mut self, approach: Option<MoveKind>) {
        self.target.clear();
        if let Some(run) = &mut self.job
            && let Some(place) = run.place
        {
            run.phase = JobPhase::Fed;
            run.begun = None;
            run.pause = None;
            // At a pause nothing waits; the approach takes the number of the move that it leads to.
            self.fill();
            self.path.resume_from(place, approach);
        }
    }

    /// Puts moves of the job on their way.
    fn fill(&mut self) {
        let Some(run) = self.job.as_mut().filter(|run| run.phase == JobPhase::Fed) else {
            return;
        };
        while self.path.waiting() < WAITING
            && run.sent < run.until
            && let Some(next) = run.job.pieces.get(run.sent)
        {
            run.sent += 1;
            let tag = run.sent as u32;
            self.path.push(&[Move { tag, ..next }]);
        }
    }

    /// Replaces a target that the controller has not accepted yet.
    pub(super) fn set_target(&mut self, target: MoveKind) {
        self.set_way([target]);
    }

    /// Replaces a target that the controller has not accepted yet by several moves to one.
    pub(super) fn set_way(&mut self, moves: impl IntoIterator<Item = MoveKind>) {
        let (tag, tool) = (0, 0);
        self.set_moves(moves.into_iter().map(|kind| Move { tag, tool, kind }));
    }

    /// Replaces a target that the controller has not accepted yet by moves, with the levels of the tool.
    pub(super) fn set_moves(&mut self, moves: impl IntoIterator<Item = Move>) {
        self.target = moves.into_iter().collect();
    }

    /// Puts the tool down or lifts it while the arm rests. The next target lifts it.
    pub(super) fn set_pen(&mut self, is_down: bool) {
        self.set_moves([Move {
            tag: 0,
            tool: if is_down { FULL_TOOL } else { 0 },
            kind: MoveKind::Dwell { duration: PEN_TIME },
        }]);
    }

    /// Whether no target waits, and the arm is where the last one led.
    pub(super) fn has_no_target(&self) -> bool {
        self.target.is_empty() && self.end.is_none()
    }

    /// The point at which the next move begins; none: the arm's present reference.
    pub(super) fn end(&self) -> Option<MoveEnd> {
        self.target
            .back()
            .and_then(|next| MoveEnd::of(&next.kind))
            .or(self.end)
    }

    /// Drops the target, and stops the job at its place.
    pub(super) fn stop(&mut self) {
        self.drop_target();
        if let Some(run) = &mut self.job {
            run.phase = match self.path.crossing() {
                Some(_) if run.phase != JobPhase::Held => JobPhase::Crossing,
                _ => JobPhase::Held,
            };
        }
    }

    /// Drops the target; the job gets no more moves, and its place is where the arm comes to rest.
    pub(super) fn leave(&mut self) {
        self.drop_target();
        if let Some(run) = self.job.as_mut().filter(|run| run.phase == JobPhase::Fed) {
            run.phase = JobPhase::Left;
        }
    }

    pub(super) fn drop_target(&mut self) {
        self.target.clear();
        self.end = None;
    }

    /// Forgets the job and its place.
    pub(super) fn forget(&mut self) {
        self.job = None;
        self.path.clear();
    }

    /// Follows the arm along the job, up to a stop or a fault.
    pub(super) fn follow(&mut self, status: &Status) -> JobStatus {
        let Some(run) = self.job.as_mut().filter(|run| run.phase != JobPhase::Held) else {
            return JobStatus::Unchanged;
        };
        if !follows_moves(status.state) {
            let before = std::mem::replace(&mut run.phase, JobPhase::Held);
            self.drop_target();
            return match before {
                JobPhase::Crossing => JobStatus::Unchanged,
                _ => JobStatus::Held,
            };
        }
        run.seen = status.tick;
        if let Some(tag) = status.tag {
            self.path.progress(tag);
        }
        if status.state == State::Crossing {
            // After a fault on its approach it begins once more.
            run.place = self.path.crossing().map(|plan| plan.from).or(run.place);
        } else {
            run.place = status.reference.or(run.place);
            run.arm = Some(*status);
            if run.phase == JobPhase::Crossing {
                run.phase = JobPhase::Held;
            }
        }
        let number = run.number(self.path.present());
        if run.present.0 != number || run.begun.is_none() {
            run.present = (number, status.tick);
        }
        let passed = number
            .checked_sub(1)
            .map_or(0.0, |last| run.job.times[last]);
        run.begun
            .get_or_insert((status.tick, run.job.done + passed));
        JobStatus::Unchanged
    }

    /// Updates the job from the controller's status and its room for further moves.
    pub(super) fn update(&mut self, status: &Status, free: u8) -> JobStatus {
        self.empty = self.empty.max(free);
        if self.follow(status) == JobStatus::Held {
            return JobStatus::Held;
        }
        if !follows_moves(status.state) {
            self.drop_target();
            return JobStatus::Unchanged;
        }
        if self.is_idle(status, free) {
            self.end = None;
            if self.is_running() {
                self.path.finish();
                if self.path.is_empty() {
                    return self.end_at_rest();
                }
            }
        }
        self.fill();
        JobStatus::Unchanged
    }

    /// Ends the job, or holds it at its pause, when all moves that it gave are done.
    fn end_at_rest(&mut self) -> JobStatus {
        match &mut self.job {
            Some(run) if run.sent < run.job.pieces.len() => {
                run.hold_at_pause();
                JobStatus::Paused
            }
            _ => {
                self.job = None;
                JobStatus::Finished
            }
        }
    }

    /// Whether all moves are done. Between two ticks a queue may be empty although its
    /// last segment has not begun, so the moves are done if this holds in two different ticks.
    fn is_idle(&mut self, status: &Status, free: u8) -> bool {
        if status.state != State::Armed || free != self.empty {
            self.idle_since = None;
            return false;
        }
        *self.idle_since.get_or_insert(status.tick) != status.tick
    }

    /// The move to send now, if there is one.
    pub(super) fn next(&self, free: u8) -> Option<Move> {
        if self.is_running() {
            return self.path.next().filter(|_| free > 0);
        }
        // A target waits until the queue is nearly empty, so that the latest one is sent.
        self.target
            .front()
            .filter(|_| free + 1 >= self.empty)
            .copied()
    }

    /// Records that the controller has accepted the move.
    pub(super) fn taken(&mut self, next: &Move) {
        if self.is_running() {
            self.path.accept();
            self.fill();
        } else {
            self.target.pop_front();
        }
        self.end = MoveEnd::of(&next.kind).or(self.end);
        self.idle_since = None;
    }

    /// Records that the controller has refused the move: the job gets no more.
    pub(super) fn refused(&mut self) {
        self.leave();
    }
}

/// Whether a controller in this state is on its way along the moves that it has, or takes some.
fn follows_moves(state: State) -> bool {
    takes_moves(state) || state == State::Crossing
}

/// Whether a controller in this state accepts moves.
pub(super) fn takes_moves(state: State) -> bool {
    matches!(state, State::Armed | State::Running)
}
