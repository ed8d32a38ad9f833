//! Moves in pieces: what remains of a move behind a place on it, and long moves divided.

use super::end;
use fivebar_files::job::arc::{angle_between, sweep};
use fivebar_firmware::{CrossingMove, Move, MoveKind, TimedMove};
use std::f64::consts::PI;

/// What remains of a move is dropped if it is shorter than this [m].
pub(super) const NEGLIGIBLE: f64 = 1e-6;
/// A move that takes longer than this at its feed rate is given in pieces [s].
const LONG: f64 = 1.0;
/// The longest time that a piece of it takes [s], unless that makes too many pieces.
const PIECE: f64 = 0.5;
/// The most pieces of a move: however slow it is, it must not fill the memory.
const MOST: f64 = 1000.0;

/// What remains of a move from a place on it [m]. Beside an arc, where a corner was rounded, the
/// arc is reached by a straight line.
pub fn remaining(place: [f32; 2], next: Move) -> Vec<Move> {
    let from = place.map(f64::from);
    match next.kind {
        MoveKind::Line { to, .. } if distance(from, to.map(f64::from)) < NEGLIGIBLE => Vec::new(),
        // No arm rests on the way: it is at the start or at the end.
        MoveKind::Crossing(plan)
            if distance(from, plan.to.map(f64::from))
                < distance(from, plan.from.map(f64::from)) =>
        {
            Vec::new()
        }
        MoveKind::Arc {
            to,
            center,
            clockwise,
            feed,
        } => {
            let (end, middle) = (to.map(f64::from), center.map(f64::from));
            let radius = distance(end, middle);
            let left = angle_between(from, end, middle, clockwise);
            // Arcs are half circles at most: a longer way means that the place is behind the end,
            // or just before the start of a half circle.
            if distance(from, end) < NEGLIGIBLE || left > 1.5 * PI {
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
        MoveKind::Line { .. }
        | MoveKind::Dwell { .. }
        | MoveKind::Joint { .. }
        | MoveKind::Timed(_)
        | MoveKind::Crossing(_) => vec![next],
    }
}

/// The moves with long ones divided: every arc longer than a half circle, so that a place on an arc
/// belongs to one remaining length only, and every move that takes long, so that a new share of the
/// feed rate takes effect on it. `from` is the place where they start [m].
pub fn divided(from: Option<[f64; 2]>, moves: &[Move]) -> Vec<Move> {
    let mut place = from;
    let mut all = Vec::new();
    for next in moves {
        if let Some(start) = place {
            divide(start, next, &mut all);
        }
        all.push(*next);
        place = end(next).map(|end| end.map(f64::from)).or(place);
    }
    all
}

/// Adds all pieces of a move but the last one.
fn divide(start: [f64; 2], next: &Move, all: &mut Vec<Move>) {
    let time = duration(Some(start.map(|value| value as f32)), next);
    let pieces = if time > LONG {
        (time / PIECE).ceil().min(MOST)
    } else {
        1.0
    };
    match next.kind {
        MoveKind::Line { to, feed } => {
            let to = to.map(f64::from);
            for piece in 1..pieces as u32 {
                let share = f64::from(piece) / pieces;
                let at = [0, 1].map(|i| (start[i] + share * (to[i] - start[i])) as f32);
                let kind = MoveKind::Line { to: at, feed };
                all.push(Move { kind, ..*next });
            }
        }
        MoveKind::Arc {
            to,
            center,
            clockwise,
            feed,
        } => {
            let middle = center.map(f64::from);
            let (_, angle) = sweep(start, to.map(f64::from), middle, clockwise);
            let pieces = if angle > PI { pieces.max(2.0) } else { pieces };
            let [dx, dy] = [start[0] - middle[0], start[1] - middle[1]];
            for piece in 1..pieces as u32 {
                let part = angle * f64::from(piece) / pieces;
                let (sin, cos) = (if clockwise { -part } else { part }).sin_cos();
                let at = [
                    middle[0] + cos * dx - sin * dy,
                    middle[1] + sin * dx + cos * dy,
                ];
                let kind = MoveKind::Arc {
                    to: at.map(|value| value as f32),
                    center,
                    clockwise,
                    feed,
                };
                all.push(Move { kind, ..*next });
            }
        }
        MoveKind::Dwell { .. }
        | MoveKind::Joint { .. }
        | MoveKind::Timed(_)
        | MoveKind::Crossing(_) => {}
    }
}

/// The time that a move takes at its feed rate [s]; 0 where its way is not known.
pub fn duration(from: Option<[f32; 2]>, next: &Move) -> f64 {
    let from = from.map(|from| from.map(f64::from));
    match (next.kind, from) {
        (MoveKind::Line { to, feed }, Some(from)) => {
            distance(from, to.map(f64::from)) / f64::from(feed)
        }
        (
            MoveKind::Arc {
                to,
                center,
                clockwise,
                feed,
            },
            Some(from),
        ) => {
            let (to, middle) = (to.map(f64::from), center.map(f64::from));
            let (radius, angle) = sweep(from, to, middle, clockwise);
            radius * angle / f64::from(feed)
        }
        (
            MoveKind::Dwell { duration }
            | MoveKind::Timed(TimedMove { duration, .. })
            | MoveKind::Crossing(CrossingMove { duration, .. }),
            _,
        ) => duration.into(),
        (MoveKind::Line { .. } | MoveKind::Arc { .. }, None) | (MoveKind::Joint { .. }, _) => 0.0,
    }
}

/// The length of a move along its path [m]; 0 where its way is not known, and for moves of other kinds than lines and
/// arcs.
pub fn length(from: Option<[f32; 2]>, next: &Move) -> f64 {
    match next.kind {
        MoveKind::Line { feed, .. } | MoveKind::Arc { feed, .. } => {
            duration(from, next) * f64::from(feed)
        }
        MoveKind::Dwell { .. }
        | MoveKind::Joint { .. }
        | MoveKind::Timed(_)
        | MoveKind::Crossing(_) => 0.0,
    }
}

/// A timed move at a share of its speed.
pub(super) fn slowed(timed: &TimedMove, share: f32) -> TimedMove {
    let [s, s_dot, s_ddot, jerk] = timed.law;
    let square = share * share;
    TimedMove {
        law: [s, share * s_dot, square * s_ddot, square * share * jerk],
        duration: timed.duration / share,
        ..*timed
    }
}

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
