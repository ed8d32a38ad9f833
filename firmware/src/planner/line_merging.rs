//! Short lines joined into longer ones, so that the look-ahead sees far enough.
//!
//! The latest line waits. If the next one goes on in nearly its direction, both become one line
//! from the start of the first to the end of the second. The points between them stay within a
//! share of the corner tolerance, and what is left of the tolerance is for the corners. A line of
//! that kind has the tag of its first move.

use super::{CheckedMove, End, MoveError, Planner};
use crate::motion::{Move, MoveKind};
use heapless::Vec;
use nalgebra::Vector2;

/// The share of the corner tolerance that the points between joined lines may use.
const SHARE: f32 = 0.2;

/// The most points between joined lines.
const POINTS: usize = 24;

/// With as many planned segments or fewer the latest line no longer waits.
const FEW_PLANNED: usize = 4;

/// Runs of the planner after which a line no longer waits for one to go on.
const LONGEST_WAIT_RUNS: u32 = 20;

/// The latest line, which waits for one that goes on in its direction.
#[derive(Clone)]
pub(super) struct Waiting {
    /// As it was asked for, but for its end.
    asked: Move,
    checked: CheckedMove,
    start: End,
    /// The points between its start and its end [m].
    points: Vec<Vector2<f32>, POINTS>,
    /// The greatest distance of a point from the line [m].
    error: f32,
    /// Runs of the planner since its last change.
    runs: u32,
}

impl Waiting {
    /// A line by itself; `None` for every other move.
    pub(super) fn new(asked: &Move, checked: CheckedMove, start: End) -> Result<Self, CheckedMove> {
        match (asked.kind, &checked) {
            (MoveKind::Line { .. }, CheckedMove::Path { .. }) => Ok(Self {
                asked: *asked,
                checked,
                start,
                points: Vec::new(),
                error: 0.0,
                runs: 0,
            }),
            _ => Err(checked),
        }
    }

    /// The line from its start to `to`, and the greatest distance of the points between, if that
    /// is at most `tolerance` [m] and the line passes them in their order.
    fn extended(&self, next: &Move, tolerance: f32) -> Option<(Move, f32)> {
        let (
            MoveKind::Line {
                to: [x, y],
                feed: before,
            },
            MoveKind::Line { to, feed },
        ) = (self.asked.kind, next.kind)
        else {
            return None;
        };
        if feed != before || next.tool != self.asked.tool || self.points.is_full() {
            return None;
        }
        let from = self.start.tool;
        let displacement = Vector2::from(to) - from;
        let length = displacement.norm();
        if !(length.is_finite() && length > 0.0) {
            return None;
        }
        let direction = displacement * (1.0 / length);
        let (mut error, mut passed) = (0.0_f32, 0.0_f32);
        for point in self.points.iter().chain([&Vector2::new(x, y)]) {
            let offset = point - from;
            let along = offset.dot(&direction);
            if !(passed <= along && along <= length) {
                return None;
            }
            passed = along;
            error = error.max(offset.perp(&direction).abs());
        }
        let asked = Move {
            kind: next.kind,
            ..self.asked
        };
        (error <= tolerance).then_some((asked, error))
    }
}

impl Planner {
    /// Makes one line of the one that waits and `next`, if that leaves both within tolerance.
    pub(super) fn join(&mut self, next: &Move) -> Option<End> {
        let waiting = self.waiting.as_ref()?;
        let (asked, error) = waiting.extended(next, SHARE * self.deviation)?;
        let (checked, end) = self.check_move(waiting.start, &asked).ok()?;
        let MoveKind::Line { to, .. } = waiting.asked.kind else {
            return None;
        };
        let waiting = self.waiting.as_mut()?;
        waiting.points.push(Vector2::from(to)).ok()?;
        (waiting.asked, waiting.checked, waiting.error) = (asked, checked, error);
        waiting.runs = 0;
        Some(end)
    }

    /// Appends the line that waits to the look-ahead.
    pub(super) fn append_waiting(&mut self) -> Result<(), MoveError> {
        let Some(waiting) = self.waiting.take() else {
            return Ok(());
        };
        let used = self.used_before.max(waiting.error);
        self.used_before = waiting.error;
        self.envelope.corner_tolerance = self.deviation - used;
        self.append(&waiting.asked, &waiting.checked, waiting.start)
    }

    /// Appends the line that waits when few others are left, or none has come for a while.
    pub(super) fn append_waiting_in_time(&mut self) {
        let few = self.lookahead.len() <= FEW_PLANNED;
        let is_due = |waiting: &mut Waiting| {
            waiting.runs += 1;
            few || waiting.runs > LONGEST_WAIT_RUNS
        };
        if self.waiting.as_mut().is_some_and(is_due) && self.lookahead.free_slots() > 0 {
            // There is room, and the move was checked.
            let _ = self.append_waiting();
        }
    }
}
