//! The moves that are on their way: those that wait, and those that the controller has accepted.
//!
//! The controller drops its path at a stop. This queue keeps the accepted moves until they are
//! done, so that after a stop it has the rest of the path, from the place where the stop began.

mod pieces;
mod shares;
#[cfg(test)]
mod tests;

use fivebar_firmware::{CrossingMove, Move, MoveKind, TimedMove};
use pieces::{NEGLIGIBLE, distance};
use std::collections::VecDeque;

pub use pieces::{divided, duration, length, remaining};
pub use shares::{RAPID, Shares};

/// Time of path behind the present move that the controller gets [s]. What waits longer here still
/// takes a new share of the feed rate. It is several times what a stop takes.
const AHEAD: f64 = 0.4;

/// A timed move that begins slower than this begins at rest [m/s].
const AT_REST: f32 = 1e-6;

/// A move under the tag that the controller knows it by. Its own tag is the caller's.
#[derive(Clone, Copy, Debug)]
struct Queued {
    tag: u32,
    next: Move,
    /// The time that it takes at the feed rate at which it was given [s].
    duration: f64,
}

/// The path behind the arm's present place.
#[derive(Debug)]
pub struct PathQueue {
    /// Accepted by the controller, with tags in ascending order; the first is in progress.
    accepted: VecDeque<Queued>,
    waiting: VecDeque<Queued>,
    last_tag: u32,
    /// What moves are given to the controller with.
    shares: Shares,
    /// The share of the speed of the latest timed moves. It changes where they begin at rest.
    timed_feed: f32,
    /// The end of the moves that were accepted [m].
    accepted_to: Option<[f32; 2]>,
}

impl Default for PathQueue {
    fn default() -> Self {
        Self {
            accepted: VecDeque::new(),
            waiting: VecDeque::new(),
            last_tag: 0,
            shares: Shares::WHOLE,
            timed_feed: 1.0,
            accepted_to: None,
        }
    }
}

impl PathQueue {
    /// Adds moves. Each gets a tag of its own towards the controller.
    pub fn push(&mut self, moves: &[Move]) {
        for &next in moves {
            self.last_tag = self.last_tag.wrapping_add(1).max(1);
            let tag = self.last_tag;
            let duration = 0.0;
            self.waiting.push_back(Queued {
                tag,
                next,
                duration,
            });
        }
    }

    /// The move to give to the controller next, at the chosen shares; none if it has
    /// enough.
    pub fn next(&self) -> Option<Move> {
        let ahead: f64 = self.accepted.iter().skip(1).map(|q| q.duration).sum();
        let Queued { tag, next, .. } = *self.waiting.front().filter(|_| ahead < AHEAD)?;
        let mut scaled = self.shares.apply(next);
        if let MoveKind::Timed(timed) = &next.kind {
            scaled.kind = MoveKind::Timed(pieces::slowed(timed, self.timed_share(timed)));
        }
        Some(Move { tag, ..scaled })
    }

    /// The share of its speed with which a timed move is given. It is the chosen one, at most 1, where
    /// the motion begins at rest, and then the same up to the next rest: a step of the speed on the
    /// way would be a jerk.
    fn timed_share(&self, timed: &TimedMove) -> f32 {
        let [_, speed, ..] = timed.law;
        if speed.abs() < AT_REST {
            self.shares.feed.min(1.0)
        } else {
            self.timed_feed
        }
    }

    /// Chooses the shares of all moves that are not accepted yet, within their limits.
    pub fn set_shares(&mut self, shares: Shares) {
        self.shares = shares.limited();
    }

    /// The shares of moves that are not accepted yet.
    pub fn shares(&self) -> Shares {
        self.shares
    }

    /// Records that the controller has accepted this move.
    pub fn accept(&mut self) {
        let Some(mut queued) = self.waiting.pop_front() else {
            return;
        };
        let mut share = self.shares.speed(&queued.next);
        if let MoveKind::Timed(timed) = &queued.next.kind {
            share = self.timed_share(timed);
            self.timed_feed = share;
        }
        queued.duration = duration(self.accepted_to, &queued.next) / f64::from(share);
        self.accepted_to = end(&queued.next).or(self.accepted_to);
        self.accepted.push_back(queued);
    }

    /// The number of moves that the controller has not accepted.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Whether the controller has accepted all moves.
    pub fn is_accepted(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Whether there is no move.
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty() && self.accepted.is_empty()
    }

    /// The caller's tag of the first move that is not done.
    pub fn present(&self) -> Option<u32> {
        let first = self.accepted.front().or(self.waiting.front())?;
        Some(first.next.tag)
    }

    /// The crossing that the controller has accepted and that is not known to be done.
    pub fn crossing(&self) -> Option<&CrossingMove> {
        self.accepted
            .iter()
            .find_map(|queued| match &queued.next.kind {
                MoveKind::Crossing(plan) => Some(plan),
                _ => None,
            })
    }

    /// Records that the move with this tag is in progress: those before it are done.
    pub fn progress(&mut self, tag: u32) {
        if let Some(index) = self.accepted.iter().position(|queued| queued.tag == tag) {
            self.accepted.drain(..index);
        }
    }

    /// Records that all accepted moves are done.
    pub fn finish(&mut self) {
        self.accepted.clear();
    }

    /// Drops the moves that the controller has not accepted.
    pub fn drop_waiting(&mut self) {
        self.waiting.clear();
    }

    /// The end of the path [m]; none if no move goes to a place.
    pub fn end(&self) -> Option<[f32; 2]> {
        let moves = self.waiting.iter().rev().chain(self.accepted.iter().rev());
        moves.filter_map(|queued| end(&queued.next)).next()
    }

    /// Drops all moves.
    pub fn clear(&mut self) {
        self.accepted.clear();
        self.waiting.clear();
    }

    /// After a stop that began at `place` [m] and has dropped the controller's path: the rest of it
    /// waits again. The stop has switched the tool off at `place`, so the arm first goes `back`
    /// there with the tool up; none: it is there.
    pub fn resume_from(&mut self, place: [f32; 2], back: Option<MoveKind>) {
        let mut rest: VecDeque<Move> = VecDeque::new();
        let mut accepted = std::mem::take(&mut self.accepted).into_iter();
        for first in accepted.by_ref() {
            let remaining = remaining(place, first.next);
            if !remaining.is_empty() {
                rest.extend(remaining);
                break;
            }
        }
        rest.extend(accepted.map(|queued| queued.next));
        let waiting = std::mem::take(&mut self.waiting);
        rest.extend(waiting.into_iter().map(|queued| queued.next));
        if let Some(kind) = back {
            let tag = rest.front().map_or(0, |first| first.tag);
            rest.push_front(Move { tag, tool: 0, kind });
        }
        let rest: Vec<Move> = rest.into();
        self.push(&rest);
    }
}

/// The straight way back from `rest_at` to `place` [m] at `speed` [m/s]; none if it is there.
pub fn way_back(rest_at: [f32; 2], place: [f32; 2], speed: f32) -> Option<MoveKind> {
    let away = distance(place.map(f64::from), rest_at.map(f64::from));
    let line = MoveKind::Line {
        to: place,
        feed: speed,
    };
    (away >= NEGLIGIBLE).then_some(line)
}

/// Where a move ends [m]; none if it goes to no place.
pub fn end(next: &Move) -> Option<[f32; 2]> {
    match next.kind {
        MoveKind::Line { to, .. } | MoveKind::Arc { to, .. } => Some(to),
        MoveKind::Timed(timed) => Some(timed.end()),
        MoveKind::Crossing(plan) => Some(plan.to),
        MoveKind::Dwell { .. } | MoveKind::Joint { .. } => None,
    }
}
