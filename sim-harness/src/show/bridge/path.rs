//! The moves that are on their way: those that wait, and those that the controller has accepted.
//!
//! The controller drops its path at a stop. This queue keeps the accepted moves until they are
//! done, so that after a stop it has the rest of the path, from the place where the arm rests.

use fivebar_firmware::{Move, MoveKind};
use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

/// What remains of a move is dropped if it is shorter than this [m].
const NEGLIGIBLE: f64 = 1e-6;

/// The path behind the arm's present place.
#[derive(Debug, Default)]
pub(super) struct PathQueue {
    /// Accepted by the controller, with tags in ascending order; the first is in progress.
    accepted: VecDeque<Move>,
    waiting: VecDeque<Move>,
    last_tag: u32,
}

impl PathQueue {
    /// Adds moves. Each gets a tag of its own.
    pub(super) fn push(&mut self, moves: &[Move]) {
        for next in moves {
            self.last_tag = self.last_tag.wrapping_add(1).max(1);
            let tag = self.last_tag;
            self.waiting.push_back(Move { tag, ..*next });
        }
    }

    /// The move to give to the controller next.
    pub(super) fn next(&self) -> Option<Move> {
        self.waiting.front().copied()
    }

    /// Records that the controller has accepted this move.
    pub(super) fn accept(&mut self) {
        self.accepted.extend(self.waiting.pop_front());
    }

    /// Whether the controller has accepted all moves.
    pub(super) fn is_accepted(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Whether there is no move.
    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty() && self.accepted.is_empty()
    }

    /// Records that the move with this tag is in progress: those before it are done.
    pub(super) fn progress(&mut self, tag: u32) {
        if let Some(index) = self.accepted.iter().position(|next| next.tag == tag) {
            self.accepted.drain(..index);
        }
    }

    /// Records that all accepted moves are done.
    pub(super) fn finish(&mut self) {
        self.accepted.clear();
    }

    /// Drops the moves that the controller has not accepted.
    pub(super) fn drop_waiting(&mut self) {
        self.waiting.clear();
    }

    /// The end of the path [m]; none if no move goes to a place.
    pub(super) fn end(&self) -> Option<[f32; 2]> {
        let moves = self.waiting.iter().rev().chain(self.accepted.iter().rev());
        let mut ends = moves.filter_map(|next| match next.kind {
            MoveKind::Line { to, .. } | MoveKind::Arc { to, .. } => Some(to),
            MoveKind::Dwell { .. } | MoveKind::Joint { .. } => None,
        });
        ends.next()
    }

    /// Drops all moves.
    pub(super) fn clear(&mut self) {
        self.accepted.clear();
        self.waiting.clear();
    }

    /// After a stop that began at `place` [m] and has dropped the controller's path: the rest of it
    /// waits again. The stop has switched the tool off at `place`, so the arm first goes back there
    /// from `rest_at` [m] at `speed` [m/s] with the tool up.
    pub(super) fn resume_from(&mut self, place: [f32; 2], rest_at: [f32; 2], speed: f32) {
        let mut rest: VecDeque<Move> = VecDeque::new();
        let mut accepted = std::mem::take(&mut self.accepted).into_iter();
        for first in accepted.by_ref() {
            let remaining = remaining(place, first);
            if !remaining.is_empty() {
                rest.extend(remaining);
                break;
            }
        }
        rest.extend(accepted);
        rest.extend(std::mem::take(&mut self.waiting));
        if distance(place.map(f64::from), rest_at.map(f64::from)) >= NEGLIGIBLE {
            let kind = MoveKind::Line {
                to: place,
                feed: speed,
            };
            let (tag, tool) = (0, 0);
            rest.push_front(Move { tag, tool, kind });
        }
        let rest: Vec<Move> = rest.into();
        self.push(&rest);
    }
}

/// What remains of a move from a place on it [m]. Beside an arc, where a corner was rounded, the
/// arc is reached by a straight line.
fn remaining(place: [f32; 2], next: Move) -> Vec<Move> {
    let from = place.map(f64::from);
    match next.kind {
        MoveKind::Line { to, .. } if distance(from, to.map(f64::from)) < NEGLIGIBLE => Vec::new(),
        MoveKind::Arc {
            to,
            center,
            clockwise,
            feed,
        } => {
            let (end, middle) = (to.map(f64::from), center.map(f64::from));
            let radius = distance(end, middle);
            let sweep = sweep(from, end, middle, clockwise);
            // Arcs are half circles at most: a longer way means that the place is behind the end,
            // or just before the start of a half circle.
            if distance(from, end) < NEGLIGIBLE || sweep > 1.5 * PI {
                return Vec::new();
            }
            let [dx, dy] = [from[0] - middle[0], from[1] - middle[1]];
            let scale = radius / dx.hypot(dy);
            let on_arc = [middle[0] + scale * dx, middle[1] + scale * dy];
            let mut moves = Vec::new();
            if distance(from, on_arc) >= NEGLIGIBLE {
                let kind = MoveKind::Line {
                    to: on_arc.map(|value| value as f32),
                    feed,
                };
                moves.push(Move { kind, ..next });
            }
            moves.push(next);
            moves
        }
        MoveKind::Line { .. } | MoveKind::Dwell { .. } | MoveKind::Joint { .. } => vec![next],
    }
}

/// The moves with every arc longer than a half circle divided into two, so that a place on an arc
/// belongs to one remaining length only. `from` is the place where they start [m].
pub(super) fn divided(from: Option<[f64; 2]>, moves: &[Move]) -> Vec<Move> {
    let mut place = from;
    let mut all = Vec::new();
    for next in moves {
        let end = match next.kind {
            MoveKind::Line { to, .. } | MoveKind::Arc { to, .. } => Some(to.map(f64::from)),
            MoveKind::Dwell { .. } | MoveKind::Joint { .. } => None,
        };
        if let (
            Some(start),
            Some(end),
            MoveKind::Arc {
                center,
                clockwise,
                feed,
                ..
            },
        ) = (place, end, next.kind)
        {
            let middle = center.map(f64::from);
            let mut angle = sweep(start, end, middle, clockwise);
            if distance(start, end) < 1e-7 {
                angle = TAU;
            }
            if angle > PI {
                let turn = if clockwise { -0.5 * angle } else { 0.5 * angle };
                let (sin, cos) = turn.sin_cos();
                let [dx, dy] = [start[0] - middle[0], start[1] - middle[1]];
                let half = [
                    middle[0] + cos * dx - sin * dy,
                    middle[1] + sin * dx + cos * dy,
                ];
                let kind = MoveKind::Arc {
                    to: half.map(|value| value as f32),
                    center,
                    clockwise,
                    feed,
                };
                all.push(Move { kind, ..*next });
            }
        }
        all.push(*next);
        place = end.or(place);
    }
    all
}

/// The angle from one place about `center` to another in the arc's sense, in 0…2π [rad].
fn sweep(from: [f64; 2], to: [f64; 2], center: [f64; 2], clockwise: bool) -> f64 {
    let angle = |[x, y]: [f64; 2]| (y - center[1]).atan2(x - center[0]);
    let turn = angle(to) - angle(from);
    (if clockwise { -turn } else { turn }).rem_euclid(TAU)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::{PathQueue, divided};
    use fivebar_firmware::{Move, MoveKind};

    fn line(to: [f32; 2]) -> Move {
        let kind = MoveKind::Line { to, feed: 0.1 };
        Move {
            tag: 0,
            tool: 7,
            kind,
        }
    }

    fn arc(to: [f32; 2], center: [f32; 2]) -> Move {
        let kind = MoveKind::Arc {
            to,
            center,
            clockwise: false,
            feed: 0.1,
        };
        Move {
            tag: 0,
            tool: 7,
            kind,
        }
    }

    fn rest(queue: &mut PathQueue) -> Vec<MoveKind> {
        let mut kinds = Vec::new();
        while let Some(next) = queue.next() {
            assert_eq!(next.tool, 7);
            kinds.push(next.kind);
            queue.accept();
        }
        kinds
    }

    #[test]
    fn after_a_stop_the_rest_of_the_path_waits_from_its_place() {
        let moves = [line([0.1, 0.0]), line([0.1, 0.1]), line([0.0, 0.1])];
        let mut queue = PathQueue::default();
        queue.push(&moves);
        queue.accept();
        queue.accept();
        queue.progress(2);
        queue.resume_from([0.1, 0.04], [0.1, 0.05], 0.3);
        assert!(!queue.is_accepted());
        // Back to where the stop began, with the tool up.
        let back = queue.next().unwrap();
        let (to, feed) = ([0.1, 0.04], 0.3);
        assert_eq!((back.tool, back.kind), (0, MoveKind::Line { to, feed }));
        queue.accept();
        assert_eq!(rest(&mut queue), [moves[1].kind, moves[2].kind]);
    }

    #[test]
    fn a_move_that_was_done_when_the_arm_came_to_rest_is_not_repeated() {
        let moves = [line([0.1, 0.0]), line([0.1, 0.1])];
        let mut queue = PathQueue::default();
        queue.push(&moves);
        queue.accept();
        queue.resume_from([0.1, 0.0], [0.1, 0.0], 0.3);
        assert_eq!(rest(&mut queue), [moves[1].kind]);
    }

    #[test]
    fn a_full_circle_is_two_half_circles_and_goes_on_from_its_place() {
        let circle = arc([0.1, 0.0], [0.0, 0.0]);
        let halves = divided(Some([0.1, 0.0]), &[circle]);
        let [MoveKind::Arc { to, .. }, MoveKind::Arc { to: end, .. }] =
            [halves[0].kind, halves[1].kind]
        else {
            panic!("{halves:?}");
        };
        assert!((to[0] + 0.1).abs() < 1e-7 && to[1].abs() < 1e-7, "{to:?}");
        assert_eq!(end, [0.1, 0.0]);
        let mut queue = PathQueue::default();
        queue.push(&halves);
        queue.accept();
        queue.accept();
        queue.progress(2);
        // Beside the arc, where a corner was rounded: a short line leads back to it.
        queue.resume_from([0.0, -0.1001], [0.0, -0.1001], 0.3);
        let kinds = rest(&mut queue);
        let MoveKind::Line { to, .. } = kinds[0] else {
            panic!("{kinds:?}");
        };
        assert!(to[0].abs() < 1e-7 && (to[1] + 0.1).abs() < 1e-7, "{to:?}");
        assert_eq!(kinds[1..], [halves[1].kind]);
    }
}
