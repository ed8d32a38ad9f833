//! Timed moves, as a host makes them that plans motion itself: runs from rest to rest, as fast as
//! the arm just allows, slower, or a little too fast; whole, or with a mistake in one piece.

use crate::bytes::Bytes;
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Planner, TimedCurve, TimedMove};

/// Where the host thinks that the tool is, so that most moves are near it [m].
pub(crate) type Tool = [f32; 2];

/// Longest piece that a controller takes [s].
const LONGEST: f32 = 0.064;
/// Steps of the search for the shortest time of a run.
const STEPS: u32 = 9;

/// A run of timed moves from rest to rest, and how a host sends it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TimedRun {
    curve: Geometry,
    /// [m].
    length: f32,
    /// Share of the time in which its speed is constant.
    cruise: f32,
    /// Its time, relative to the shortest that a controller takes.
    slower: f32,
    /// Longest piece [s].
    piece: f32,
    mistake: Mistake,
    /// The piece with the mistake.
    wrong: u8,
    /// Pieces that are sent; the others never come.
    pub(crate) sent: usize,
    /// Greatest time that the host waits for rest before it, and for room before each piece [ticks].
    pub(crate) patience: u16,
    /// Ticks between two pieces.
    pub(crate) between: u16,
    /// The level of the tool.
    pub(crate) tool: u16,
}

/// The geometry of a run, from where the tool is.
#[derive(Clone, Copy, Debug)]
enum Geometry {
    Line {
        direction: f32,
    },
    Arc {
        direction: f32,
        curvature: f32,
    },
    Blend {
        direction: f32,
        /// c₂ … c₅ as shares of the length.
        bends: [[f32; 2]; 4],
    },
}

/// What is wrong with one piece.
#[derive(Clone, Copy, Debug)]
enum Mistake {
    None,
    /// A number of the law or the duration is a little different, or much.
    Law(usize, f32),
    /// A number of the curve is.
    Curve(usize, f32),
    /// A number is any.
    Bits(usize, u32),
    /// It is left out.
    Missing,
    /// It comes twice.
    Twice,
}

/// A run of timed moves that `bytes` describe, from rest at `start` [m] to rest: `slower` times as long as
/// the shortest that the planner takes. Empty where it takes none.
pub fn timed_run(bytes: &[u8], slower: f32, start: [f32; 2], planner: &Planner) -> Vec<TimedMove> {
    let run = TimedRun {
        slower,
        mistake: Mistake::None,
        ..TimedRun::from_bytes(&mut Bytes(bytes))
    };
    let pieces = run.pieces(start, planner);
    let is_taken = |&timed: &TimedMove| planner.check(start, &unnamed(timed)).is_ok();
    if pieces.iter().all(is_taken) {
        pieces
    } else {
        Vec::new()
    }
}

fn unnamed(timed: TimedMove) -> Move {
    Move {
        tag: 0,
        tool: 0,
        kind: MoveKind::Timed(timed),
    }
}

impl TimedRun {
    pub(crate) fn from_bytes(bytes: &mut Bytes<'_>) -> Self {
        let direction = bytes.within(-3.2, 3.2);
        let length = [0.004, 0.02, 0.05, 0.12][usize::from(bytes.byte() % 4)];
        let length = length * bytes.within(0.3, 1.0);
        let curve = match bytes.byte() {
            0..=109 => Geometry::Line { direction },
            110..=184 => Geometry::Arc {
                direction,
                // Up to two turns.
                curvature: bytes.within(-12.0, 12.0) / length,
            },
            185..=255 => Geometry::Blend {
                direction,
                bends: [(); 4].map(|()| bytes.pair(-0.6, 0.6)),
            },
        };
        let how = bytes.byte();
        Self {
            curve,
            length,
            cruise: bytes.within(0.0, 0.8),
            slower: match how {
                0..=99 => 1.0,
                100..=199 => bytes.within(1.0, 3.0),
                200..=229 => bytes.within(0.5, 1.0),
                230..=255 => bytes.within(0.97, 1.0),
            },
            piece: match bytes.byte() {
                0..=127 => LONGEST,
                128..=239 => bytes.within(0.003, LONGEST),
                240..=255 => bytes.within(1e-4, 0.003),
            },
            mistake: mistake(bytes),
            wrong: bytes.byte(),
            sent: match bytes.byte() {
                0..=229 => usize::MAX,
                few => usize::from(few - 229),
            },
            patience: if bytes.byte() < 230 { 2000 } else { 0 },
            between: match bytes.byte() {
                0..=199 => 0,
                ticks => u16::from(ticks - 199) * 4,
            },
            tool: [0, FULL_TOOL, 20_000][usize::from(bytes.byte() / 100)],
        }
    }

    /// The pieces of the run from `start` [m] on. None where the arm takes no such run.
    pub(crate) fn pieces(&self, start: Tool, planner: &Planner) -> Vec<TimedMove> {
        let keeps_limits = |time: f32| {
            let mut pieces = self.exact(start, time).into_iter();
            pieces.all(|timed| planner.check(start, &unnamed(timed)).is_ok())
        };
        // Of a slow run only the path matters; each step halves the range of the logarithm.
        let (mut short, mut long) = (0.005, 1.0_f32);
        if !keeps_limits(long) {
            return self.exact(start, long);
        }
        for _ in 0..STEPS {
            let middle = (short * long).sqrt();
            *(if keeps_limits(middle) {
                &mut long
            } else {
                &mut short
            }) = middle;
        }
        let mut pieces = self.exact(start, long * self.slower);
        self.mistake.put_into(&mut pieces, self.wrong.into());
        pieces
    }

    /// The run in this time [s], as planned.
    fn exact(&self, start: Tool, time: f32) -> Vec<TimedMove> {
        let cruise = self.cruise * time;
        let phase = 0.25 * (time - cruise);
        let jerk = self.length / (2.0 * phase * phase * phase + phase * phase * cruise);
        let curve = self.curve.from(start, self.length);
        let (mut s, mut v, mut a) = (0.0, 0.0, 0.0);
        let mut pieces = Vec::new();
        for (duration, jerk) in [
            (phase, jerk),
            (phase, -jerk),
            (cruise, 0.0),
            (phase, -jerk),
            (phase, jerk),
        ] {
            // The queue of the planner is short enough for this many.
            let count = (duration / self.piece).ceil().min(40.0);
            let t = duration / count;
            for _ in 0..count as u32 {
                pieces.push(TimedMove {
                    curve,
                    law: [s, v, a, jerk],
                    duration: t,
                });
                s += t * (v + t * (a / 2.0 + t * jerk / 6.0));
                v = (v + t * (a + t * jerk / 2.0)).max(0.0);
                a += t * jerk;
            }
        }
        pieces
    }
}

impl Geometry {
    fn from(self, start: Tool, length: f32) -> TimedCurve {
        let unit = |angle: f32| [angle.cos(), angle.sin()];
        match self {
            Self::Line { direction } => TimedCurve::Line {
                start,
                tangent: unit(direction),
            },
            Self::Arc {
                direction,
                curvature,
            } => TimedCurve::Arc {
                start,
                tangent: unit(direction),
                curvature,
            },
            Self::Blend { direction, bends } => {
                let along = unit(direction).map(|share| share * length);
                let [c2, c3, c4, c5] = bends.map(|bend| bend.map(|share| share * length));
                TimedCurve::Blend {
                    coefficients: [start, along, c2, c3, c4, c5],
                    // A little longer than the run, whose end is only as exact as single precision.
                    inverse_length: 0.99 / length,
                }
            }
        }
    }
}

fn mistake(bytes: &mut Bytes<'_>) -> Mistake {
    let kind = bytes.byte();
    let (number, change) = (usize::from(bytes.byte()), bytes.short());
    // Around the differences that a controller takes for rounding, or any.
    let little = [-4e-6, -1e-6, 1e-6, 4e-6, 1e-3, 4e-3, 0.8, 3.0][usize::from(change % 8)];
    match kind {
        0..=169 => Mistake::None,
        170..=194 => Mistake::Law(number, little),
        195..=214 => Mistake::Curve(number, little),
        215..=239 => Mistake::Bits(number, bytes.word()),
        240..=247 => Mistake::Missing,
        248..=255 => Mistake::Twice,
    }
}

impl Mistake {
    fn put_into(self, pieces: &mut Vec<TimedMove>, wrong: usize) {
        if pieces.is_empty() {
            return;
        }
        let wrong = wrong % pieces.len();
        let piece = &mut pieces[wrong];
        match self {
            Self::None => {}
            Self::Law(number, change) => *law_number(piece, number) += change,
            Self::Curve(number, change) => *curve_number(piece, number) += change,
            Self::Bits(number, bits) if number < 128 => {
                *law_number(piece, number) = f32::from_bits(bits);
            }
            Self::Bits(number, bits) => *curve_number(piece, number) = f32::from_bits(bits),
            Self::Missing => {
                pieces.remove(wrong);
            }
            Self::Twice => pieces.insert(wrong, pieces[wrong]),
        }
    }
}

fn law_number(piece: &mut TimedMove, number: usize) -> &mut f32 {
    match number % 5 {
        4 => &mut piece.duration,
        other => &mut piece.law[other],
    }
}

fn curve_number(piece: &mut TimedMove, number: usize) -> &mut f32 {
    let (of, xy) = (number / 2, number % 2);
    match &mut piece.curve {
        TimedCurve::Line { start, tangent } => &mut [start, tangent][of % 2][xy],
        TimedCurve::Arc { curvature, .. } if of % 3 == 2 => curvature,
        TimedCurve::Arc { start, tangent, .. } => &mut [start, tangent][of % 3][xy],
        TimedCurve::Blend {
            coefficients,
            inverse_length,
        } => match coefficients.get_mut(of % 7) {
            Some(coefficient) => &mut coefficient[xy],
            None => inverse_length,
        },
    }
}
