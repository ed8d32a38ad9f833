//! A run as cubic pieces, each on one piece of its path: what a controller can follow.
//!
//! The least-time run is smoothed by a [`Spline`]. Where that passes a limit, x = ṡ² of the run is
//! bounded lower there and for some time before and after, and the run is planned again, until every limit holds in
//! the middle and at the ends of every cell.

use super::demand::DrivenArm;
use super::error::PlanError;
use super::grid::{Grid, Solved};
use super::limits::PlanLimits;
use super::path::PathPiece;
use super::plan::check;
use super::spline::{Spline, State, later, time_at};

/// A cubic in time on one piece of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPiece {
    /// The index of the path's piece.
    pub piece: usize,
    /// s on that piece, ṡ and s̈ at its beginning, and the constant s⃛.
    pub law: [f64; 4],
    /// [s].
    pub duration: f64,
}

/// How a run is smoothed: between two knots of its spline the acceleration changes evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoothing {
    /// The time between two knots is at most so long [s]: the shorter, the faster and the less smooth the run.
    Knots(f64),
    /// For drives that swing with twice this period [s]: the run is the mean of itself and of itself so much later. Each
    /// change of acceleration comes in two halves, of which the second one ends the swing that the first one began
    /// (a zero-vibration shaper: Singer and Seering, 1990).
    HalfSwing(f64),
}

/// The knots of a run's spline.
struct Knots {
    /// Their intervals in a run that is not smoothed.
    count: f64,
    /// [s].
    interval: f64,
    /// The intervals by which the second half of each change of acceleration is later.
    later: usize,
}

impl Smoothing {
    /// The knots of a run that would take `total` [s] without it.
    fn of(self, total: f64) -> Knots {
        match self {
            Self::Knots(most) => {
                let count = (total / most).ceil().max(FEWEST);
                Knots {
                    count,
                    interval: total / count,
                    later: 0,
                }
            }
            Self::HalfSwing(half) => {
                let interval = half / IN_HALF_A_SWING as f64;
                Knots {
                    // A run that does not fill its last interval goes on a little more slowly, so that none is shorter.
                    count: (total / interval).ceil(),
                    interval,
                    later: IN_HALF_A_SWING,
                }
            }
        }
    }
}

/// A run in cubic pieces, with continuous acceleration.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedRun {
    /// The pieces in their order.
    pub pieces: Vec<TimedPiece>,
    /// Its duration [s].
    pub time: f64,
    /// Most by which a limit is passed in a cell, relative.
    pub limit_excess: f64,
}

/// Most rounds of bounding and planning again.
const ROUNDS: usize = 60;
/// The excess of a limit that is accepted, relative.
const ACCEPTED: f64 = 5e-3;
/// The part of an excess by which x is bounded lower in one round, and the least part.
const STEP: f64 = 1.0;
/// Fewest intervals of a run.
const FEWEST: f64 = 4.0;
/// Intervals in half a swing: with more the run takes less longer, and has more pieces.
const IN_HALF_A_SWING: usize = 4;
/// Pieces shorter than this are merged into their neighbour [s].
const SHORTEST: f64 = 2e-7;
/// The longest slowing at the end, for limits that bounds of x do not keep.
const SLOWEST: f64 = 1.5;

/// The run along pieces that follow one another, from rest to rest, in cubics, smoothed like this.
///
/// # Errors
/// [`PlanError`], with s where it was found.
pub fn plan_timed(
    arm: &DrivenArm,
    limits: &PlanLimits,
    pieces: &[PathPiece],
    smoothing: Smoothing,
) -> Result<TimedRun, PlanError> {
    check(limits, pieces)?;
    let even_points = 2 + (Grid::length_of(pieces) / 1e-3).ceil() as usize;
    let mut solved = Grid::new(arm, limits, pieces, even_points)?.solve()?;
    let mut caps = vec![f64::INFINITY; solved.x.len()];
    let mut best: Option<(f64, Spline)> = None;
    for _ in 0..ROUNDS {
        let times = times(&solved);
        let knots = smoothing.of(times[times.len() - 1]);
        let spline = smoothed(&solved, &times, &knots);
        // What acts at a time is the run of an interval before and after, and of the time by which its half is later.
        let around = spline.interval * (1.0 + 0.5 * knots.later as f64);
        let worst = bound(&solved, &times, (&spline, around), &mut caps);
        if best.as_ref().is_none_or(|(least, _)| worst < *least) {
            best = Some((worst, spline));
        }
        if worst <= ACCEPTED {
            break;
        }
        solved.solve_below(&caps);
    }
    let (mut excess, mut spline) = best.ok_or(PlanError::Jerk)?;
    let mut kappa = 1.0;
    while excess > ACCEPTED && kappa < SLOWEST {
        let step = (1.0 + excess).sqrt().min(1.1);
        kappa *= step;
        spline = spline.slowed(step);
        excess = excess_of(&solved, &spline);
    }
    if excess > ACCEPTED {
        return Err(PlanError::Jerk);
    }
    Ok(TimedRun {
        time: spline.duration(),
        pieces: cut(&spline, pieces),
        limit_excess: excess.max(0.0),
    })
}

/// The time at each node.
fn times(solved: &Solved<'_>) -> Vec<f64> {
    let mut t = vec![0.0];
    for (cell, ends) in solved.grid.cells.iter().zip(solved.x.windows(2)) {
        let dt = 2.0 * cell.w / (ends[0].sqrt() + ends[1].sqrt());
        t.push(t[t.len() - 1] + dt);
    }
    t
}

/// The spline of a run at even times.
fn smoothed(solved: &Solved<'_>, times: &[f64], knots: &Knots) -> Spline {
    let &Knots {
        count,
        interval,
        later,
    } = knots;
    let h = times[times.len() - 1] / count;
    let (cells, x) = (&solved.grid.cells, &solved.x);
    let mut i = 0;
    let mut samples = Vec::with_capacity(count as usize + 1);
    for k in 0..count as usize {
        let t = h * k as f64;
        while i + 1 < cells.len() && times[i + 1] <= t {
            i += 1;
        }
        let u = 0.5 * (x[i + 1] - x[i]) / cells[i].w;
        let dt = t - times[i];
        let s = cells[i].s + dt * (x[i].sqrt() + 0.5 * dt * u);
        samples.push(s.min(cells[i].s + cells[i].w));
    }
    samples.push(solved.grid.length());
    Spline::new(&mean_of_two(&samples, later), interval)
}

/// The mean of samples and of the same samples so many later.
fn mean_of_two(samples: &[f64], later: usize) -> Vec<f64> {
    let last = samples.len() - 1;
    let mean = |k: usize| 0.5 * (samples[k.min(last)] + samples[k.saturating_sub(later)]);
    (0..=last + later).map(mean).collect()
}

/// A point that moves along a spline by s.
struct SplineCursor<'a> {
    spline: &'a Spline,
    interval: usize,
    state: State,
    end: f64,
}

impl<'a> SplineCursor<'a> {
    fn new(spline: &'a Spline) -> Self {
        Self {
            spline,
            interval: 0,
            state: spline.start(0),
            end: later(spline.start(0), spline.interval)[0],
        }
    }

    /// The state at s, which rises from call to call.
    fn at(&mut self, s: f64) -> State {
        while self.end < s && self.interval + 1 < self.spline.len() {
            self.interval += 1;
            self.state = self.spline.start(self.interval);
            self.end = later(self.state, self.spline.interval)[0];
        }
        let t = time_at(self.state, s, self.spline.interval);
        later(self.state, t)
    }
}

/// The excess of each cell: the most by which a limit is passed at its ends or in its middle.
fn excesses(solved: &Solved<'_>, spline: &Spline) -> Vec<f64> {
    let grid = &solved.grid;
    let mut cursor = SplineCursor::new(spline);
    let used = |[_, v, a, _]: State, index| grid.used(index, v * v, a);
    let mut start = cursor.at(0.0);
    let cells = grid.cells.iter();
    cells
        .map(|cell| {
            let middle = cursor.at(cell.s + 0.5 * cell.w);
            let end = cursor.at(cell.s + cell.w);
            let most = used(start, cell.start)
                .max(used(middle, cell.middle))
                .max(used(end, cell.end));
            start = end;
            most - 1.0
        })
        .collect()
}

fn excess_of(solved: &Solved<'_>, spline: &Spline) -> f64 {
    excesses(solved, spline).into_iter().fold(0.0, f64::max)
}

/// Bounds x lower for this time [s] around each place where the spline passes a limit, and returns the greatest excess.
fn bound(
    solved: &Solved<'_>,
    times: &[f64],
    (spline, around): (&Spline, f64),
    caps: &mut [f64],
) -> f64 {
    let excesses = excesses(solved, spline);
    let mut factors = vec![1.0_f64; caps.len()];
    for (i, &excess) in excesses
        .iter()
        .enumerate()
        .filter(|(_, e)| **e > 0.5 * ACCEPTED)
    {
        let factor = 1.0 / (1.0 + STEP * excess.min(1.0));
        let (from, to) = (times[i] - around, times[i + 1] + around);
        let first = times.partition_point(|&t| t < from);
        let last = times.partition_point(|&t| t <= to);
        for other in &mut factors[first..last] {
            *other = other.min(factor);
        }
    }
    for ((cap, factor), x) in caps.iter_mut().zip(factors).zip(&solved.x) {
        if factor < 1.0 && *x > 0.0 {
            *cap = cap.min(factor * x);
        }
    }
    excesses.into_iter().fold(0.0, f64::max)
}

/// The cubics between the knots, cut where pieces of the path meet.
fn cut(spline: &Spline, pieces: &[PathPiece]) -> Vec<TimedPiece> {
    let mut timed = Vec::with_capacity(spline.len() + pieces.len());
    let (mut piece, mut begin) = (0, 0.0);
    for interval in 0..spline.len() {
        let mut state = spline.start(interval);
        let mut left = spline.interval;
        while left > 0.0 {
            let end = begin + pieces[piece].length();
            let crosses = piece + 1 < pieces.len() && later(state, left)[0] > end;
            let mut duration = if crosses {
                time_at(state, end, left)
            } else {
                left
            };
            if left - duration < SHORTEST {
                duration = left;
            }
            if duration >= SHORTEST || !crosses {
                let [s, v, a, j] = state;
                timed.push(TimedPiece {
                    piece,
                    law: [s - begin, v, a, j],
                    duration,
                });
                state = later(state, duration);
                left -= duration;
            }
            if crosses {
                (piece, begin) = (piece + 1, end);
            }
        }
    }
    timed
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// The swing that a run at full acceleration, forwards and then back, leaves in an undamped oscillator of this period [s],
    /// of the one that its acceleration bends steadily.
    fn swing_left(smoothing: Smoothing, period: f64) -> f64 {
        const TOTAL: f64 = 0.0473;
        let Knots {
            count,
            interval,
            later,
        } = smoothing.of(TOTAL);
        let samples: Vec<f64> = (0..=count as usize)
            .map(|k| {
                let share = k as f64 / count;
                let rest = 1.0 - share;
                if share < 0.5 {
                    2.0 * share * share
                } else {
                    1.0 - 2.0 * rest * rest
                }
            })
            .collect();
        let spline = Spline::new(&mean_of_two(&samples, later), interval);
        // x″ + ω² x = s̈: what is left is |∫ s̈ exp(jωt) dt|/ω, by its definition in small steps.
        let (omega, parts) = (TAU / period, 200);
        let (mut re, mut im) = (0.0, 0.0);
        for k in 0..spline.len() {
            let start = spline.start(k);
            for part in 0..parts {
                let t = (f64::from(part) + 0.5) * spline.interval / f64::from(parts);
                let [.., a, _] = super::later(start, t);
                let angle = omega * (k as f64 * spline.interval + t);
                re += a * angle.cos() * spline.interval / f64::from(parts);
                im += a * angle.sin() * spline.interval / f64::from(parts);
            }
        }
        let greatest = 4.0 / (TOTAL * TOTAL);
        re.hypot(im) / omega / (greatest / (omega * omega))
    }

    #[test]
    fn a_run_in_two_halves_leaves_no_swing_of_its_period_and_hardly_any_of_one_near_it() {
        for half in [5.5e-3, 7.1e-3] {
            let left = |period| swing_left(Smoothing::HalfSwing(half), period);
            assert!(left(2.0 * half) < 1e-3, "{}", left(2.0 * half));
            for off in [0.85, 1.15] {
                // cos(π/2 · 1/off) of the 4 that three changes, of 1, 2 and 1, leave at most.
                let bound = 4.0 * (0.5 * PI / off).cos().abs();
                assert!(
                    left(2.0 * half * off) < bound,
                    "{off}: {}",
                    left(2.0 * half * off)
                );
            }
            let without =
                [0.9, 1.0, 1.1].map(|off| swing_left(Smoothing::Knots(1e-3), 2.0 * half * off));
            assert!(without.into_iter().fold(0.0, f64::max) > 1.0, "{without:?}");
        }
    }
}
