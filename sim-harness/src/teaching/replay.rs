//! A taught path as timed moves at any speed, checked as a whole, and as strokes of a drawing.

use super::TaughtPath;
use crate::learning::Spline;
use fivebar_firmware::planner::MoveError;
use fivebar_firmware::{Move, MoveKind, Planner, TimedCurve, TimedMove};
use nalgebra::Vector2;
use std::fmt::Write;

/// The slowest and the fastest replay, in times of the taught speed: pieces are as short as 2 ms then, and rounding makes steps of shorter
/// ones.
pub const LEAST_SPEED: f64 = 0.05;
/// See [`LEAST_SPEED`].
pub const MOST_SPEED: f64 = 5.0;
/// The speed at which the tip goes to the beginning of a path [m/s].
const APPROACH: f32 = 0.1;
/// The rest there, before the path [s].
const REST: f32 = 0.2;
/// The longest piece [s]; a controller takes none that lasts longer than 64 ms.
const LONGEST_PIECE: f64 = 0.06;
/// Rounds of the search for the greatest speed.
const ROUNDS: u32 = 12;
/// A tip slower than this may be taken for one at rest [m/s].
const SLOW: f64 = 1.2e-3;
/// An acceleration that one at rest does not have [m/s²].
const STEADY: f64 = 0.5;

/// Why a path is not replayed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The speed.
    #[error("the speed must be from {LEAST_SPEED} to {MOST_SPEED} times the taught one, not {0}")]
    Speed(f64),
    /// The arm cannot follow it so fast.
    #[error(
        "at {speed} times the taught speed, {time:.2} s after the beginning: {error}; at {possible:.2} times it is possible"
    )]
    TooFast {
        /// The speed that was asked for.
        speed: f64,
        /// Where [s of the taught path].
        time: f64,
        /// Why not.
        error: MoveError,
        /// A speed at which the arm follows it.
        possible: f64,
    },
    /// The arm cannot follow it at any speed.
    #[error("{time:.2} s after the beginning: {error}")]
    Refused {
        /// Where [s of the taught path].
        time: f64,
        /// Why not.
        error: MoveError,
    },
}

impl TaughtPath {
    /// The moves of a replay at this multiple of the taught speed: to its beginning, a rest, and the path. They are checked from a
    /// tip that is here [m], with these joint angles [rad], by a planner like the controller's.
    ///
    /// # Errors
    /// Why the arm cannot follow it, and how fast it can.
    pub fn replay(
        &self,
        speed: f64,
        planner: &Planner,
        tip: [f32; 2],
        angles: [f32; 2],
    ) -> Result<Vec<Move>, ReplayError> {
        if !(LEAST_SPEED..=MOST_SPEED).contains(&speed) {
            return Err(ReplayError::Speed(speed));
        }
        let check = |speed: f64| {
            let moves = self.moves(speed);
            let checked = planner.clone().check_all_from(tip, Some(angles), &moves);
            checked.map(|()| moves)
        };
        let time = |error: &MoveError| f64::from(error.tag.saturating_sub(1)) * self.knot_s;
        let error = match check(speed) {
            Ok(moves) => return Ok(moves),
            Err(error) => error,
        };
        if let Err(error) = check(LEAST_SPEED) {
            return Err(ReplayError::Refused {
                time: time(&error),
                error,
            });
        }
        let (mut possible, mut too_fast) = (LEAST_SPEED, speed);
        for _ in 0..ROUNDS {
            let between = (possible * too_fast).sqrt();
            match check(between) {
                Ok(_) => possible = between,
                Err(_) => too_fast = between,
            }
        }
        Err(ReplayError::TooFast {
            speed,
            time: time(&error),
            error,
            // So that its two digits are not too fast.
            possible: (possible * 100.0).floor() / 100.0,
        })
    }

    /// The moves; the tag of a piece is one more than the number of its first knot.
    fn moves(&self, speed: f64) -> Vec<Move> {
        let knots: Vec<Vector2<f64>> = self.tip_m.iter().map(|&point| point.into()).collect();
        let start = self.tip_m.first().map(|point| point.map(|x| x as f32));
        let spline = Spline::through(knots);
        let knot_time = self.knot_s / speed;
        let (tag, tool) = (0, 0);
        let to_start = start.into_iter().flat_map(|to| {
            let line = MoveKind::Line { to, feed: APPROACH };
            [line, MoveKind::Dwell { duration: REST }]
        });
        let mut moves: Vec<Move> = to_start.map(|kind| Move { tag, tool, kind }).collect();
        // s rises evenly with time, faster than the tip.
        let steps = spline.knots().windows(2);
        let longest = steps.map(|pair| (pair[1] - pair[0]).norm());
        let rate = 2.0 * (1e-3 + longest.fold(0.0, f64::max) / knot_time);
        // The controller takes a piece that ends slowly as one that ends at rest.
        let turns = |velocity: Vector2<f64>, acceleration: Vector2<f64>| {
            velocity.norm() < SLOW * knot_time
                && acceleration.norm() > STEADY * knot_time * knot_time
        };
        for span in spline.spans(turns) {
            let whole = span.knots as f64 * knot_time;
            let parts = (whole / LONGEST_PIECE).ceil().max(1.0);
            let duration = whole / parts;
            for part in 0..parts as u32 {
                let from = f64::from(part) / parts;
                let coefficients = span.part(from, from + 1.0 / parts);
                let curve = TimedCurve::Blend {
                    coefficients: coefficients.map(|c| [c.x as f32, c.y as f32]),
                    inverse_length: (1.0 / (rate * duration)) as f32,
                };
                moves.push(Move {
                    tag: u32::try_from(span.begin + 1).unwrap_or(u32::MAX),
                    tool,
                    kind: MoveKind::Timed(TimedMove {
                        curve,
                        law: [0.0, rate as f32, 0.0, 0.0],
                        duration: duration as f32,
                    }),
                });
            }
        }
        moves
    }

    /// The path as G-code in millimetres, drawn with the pen down at its mean speed.
    pub fn to_gcode(&self) -> String {
        let feed = 60e3 * self.length() / self.time().max(f64::MIN_POSITIVE);
        let mut text = String::from("G21 G90\n");
        for (k, [x, y]) in self.tip_m.iter().map(|it| it.map(|x| 1e3 * x)).enumerate() {
            // A String takes all that is written.
            let _ = match k {
                0 => writeln!(text, "G0 X{x:.4} Y{y:.4}\nM3"),
                1 => writeln!(text, "G1 X{x:.4} Y{y:.4} F{feed:.1}"),
                _ => writeln!(text, "G1 X{x:.4} Y{y:.4}"),
            };
        }
        text + "M5\n"
    }

    /// The path as a drawing in SVG, 1 mm to a unit. Its y points down, so the path's is reversed.
    pub fn to_svg(&self) -> String {
        let points: Vec<[f64; 2]> = (self.tip_m.iter())
            .map(|[x, y]| [1e3 * x, -1e3 * y])
            .collect();
        let ends = |k: usize| {
            let values = points.iter().map(|point| point[k]);
            let least = values.clone().fold(f64::INFINITY, f64::min);
            (least - 1.0, values.fold(f64::NEG_INFINITY, f64::max) + 1.0)
        };
        let ((left, right), (top, bottom)) = (ends(0), ends(1));
        let (width, height) = (right - left, bottom - top);
        let line: Vec<String> = points
            .iter()
            .map(|[x, y]| format!("{x:.4},{y:.4}"))
            .collect();
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.4}mm\" height=\"{height:.4}mm\" \
             viewBox=\"{left:.4} {top:.4} {width:.4} {height:.4}\">\n\
             <polyline fill=\"none\" stroke=\"black\" stroke-width=\"0.3\" points=\"{}\"/>\n</svg>\n",
            line.join(" ")
        )
    }
}
