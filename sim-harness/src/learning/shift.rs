//! The shift of a path: learnt from a run's errors, smoothed, bounded, and the same at both ends of a rest.

use super::contraction::{Filter, SHARE};
use super::follower::Tick;
use super::spline::Spline;
use super::timed_path::TimedPath;
use nalgebra::Vector2;

/// Knots beside a rest at which the shift is that of the rest.
const STILL: usize = 2;
/// Knots behind them over which it goes over into that of the motion.
const OVER: usize = 4;
/// Deviations of the Gaussian at which it is cut off.
const CUT: f64 = 4.0;

/// A path with its shift.
#[derive(Clone, Debug, PartialEq)]
pub struct Learnt {
    pub(super) path: TimedPath,
    /// Of each motion.
    pub(super) shifts: Vec<Spline>,
}

/// Errors of a run by the ticks of the path, motion by motion [m].
pub(super) type Errors = Vec<Vec<Vector2<f64>>>;

impl Learnt {
    /// Nothing learnt yet.
    pub(super) fn nothing(path: TimedPath) -> Self {
        let still = |spline: &Spline| Spline::through(vec![Vector2::zeros(); spline.knots().len()]);
        let shifts = path.motions.iter().map(|motion| still(&motion.wanted));
        Self {
            shifts: shifts.collect(),
            path,
        }
    }

    /// What the controller is to follow.
    pub(super) fn streamed(&self) -> Vec<Spline> {
        let both = self.path.motions.iter().zip(&self.shifts);
        let sum = |wanted: &Spline, shift: &Spline| {
            let knots = wanted.knots().iter().zip(shift.knots());
            Spline::through(knots.map(|(wanted, shift)| wanted + shift).collect())
        };
        both.map(|(motion, shift)| sum(&motion.wanted, shift))
            .collect()
    }

    /// Greatest shift [m].
    pub fn greatest(&self) -> f64 {
        let knots = self.shifts.iter().flat_map(Spline::knots);
        knots.map(Vector2::norm).fold(0.0, f64::max)
    }

    /// The errors of a run by the ticks of the path. A place that the run passed twice has their mean, and one between
    /// two ticks the error of the last place.
    pub(super) fn errors(&self, ticks: &[Tick]) -> Errors {
        let counts = self.path.motions.iter().map(|motion| {
            vec![(Vector2::zeros(), 0.0); motion.wanted.pieces() * self.path.knot_ticks + 1]
        });
        let mut sums: Vec<Vec<(Vector2<f64>, f64)>> = counts.collect();
        for tick in ticks {
            let sum = tick
                .place
                .and_then(|(motion, at)| sums.get_mut(motion)?.get_mut(at));
            if let (Some(error), Some((sum, count))) = (tick.error, sum) {
                *sum += error;
                *count += 1.0;
            }
        }
        let filled = |ticks: Vec<(Vector2<f64>, f64)>| {
            let first = ticks.iter().find(|(_, count)| *count > 0.0);
            let mut last = first.map_or(Vector2::zeros(), |(sum, count)| sum / *count);
            let mean = ticks.into_iter().map(|(sum, count)| {
                if count > 0.0 {
                    last = sum / count;
                }
                last
            });
            mean.collect()
        };
        sums.into_iter().map(filled).collect()
    }

    /// The shift for the next run, none of it greater than `bound` [m].
    #[must_use]
    pub(super) fn next(&self, errors: &Errors, filter: &Filter, bound: f64) -> Self {
        let path = &self.path;
        let period = path.period();
        let window = Window::new(Filter::deviation(filter.half) / period);
        let mut knots: Vec<Vec<Vector2<f64>>> = Vec::new();
        for (shift, errors) in self.shifts.iter().zip(errors) {
            let sums: Vec<Vector2<f64>> = errors
                .iter()
                .enumerate()
                .map(|(tick, error)| path.at(shift, tick) + error * SHARE)
                .collect();
            let of_knot = |k: usize| bounded(window.mean(&sums, k * path.knot_ticks), bound);
            knots.push((0..shift.knots().len()).map(of_knot).collect());
        }
        rest(&mut knots);
        Self {
            path: path.clone(),
            shifts: knots.into_iter().map(Spline::through).collect(),
        }
    }
}

/// Lets the shift rest where the arm does and just before and behind: there a shift that changes turns the slow joints
/// about, and their friction with them, which no next run would repeat. The first motion begins without a shift.
fn rest(knots: &mut [Vec<Vector2<f64>>]) {
    let near = |count: usize| STILL.min(count.saturating_sub(1));
    let mut start = Vector2::zeros();
    for motion in 0..knots.len() {
        let next = knots.get(motion + 1).map(|next| next[near(next.len())]);
        let own = &mut knots[motion];
        let count = own.len();
        let end = own[count - 1 - near(count)];
        let end = next.map_or(end, |next| (end + next) * 0.5);
        settle(own.iter_mut(), start);
        settle(own.iter_mut().rev(), end);
        start = end;
    }
}

/// The first knots are still at a place, and the ones behind go over to their own.
fn settle<'a>(knots: impl Iterator<Item = &'a mut Vector2<f64>>, place: Vector2<f64>) {
    let mut step = Vector2::zeros();
    let mut knots: Vec<&mut Vector2<f64>> = knots.take(STILL + OVER).collect();
    if let Some(last) = knots.get(STILL).or(knots.last()) {
        step = place - **last;
    }
    for (k, knot) in knots.iter_mut().enumerate() {
        match k.checked_sub(STILL) {
            None => **knot = place,
            Some(over) => **knot += step * (1.0 - over as f64 / OVER as f64),
        }
    }
}

fn bounded(shift: Vector2<f64>, bound: f64) -> Vector2<f64> {
    let size = shift.norm();
    if size > bound {
        shift * (bound / size)
    } else {
        shift
    }
}

/// A Gaussian over ticks.
struct Window(Vec<f64>);

impl Window {
    /// With this standard deviation in ticks.
    fn new(deviation: f64) -> Self {
        let reach = (CUT * deviation).ceil() as usize;
        let weight = |tick: usize| (-0.5 * (tick as f64 / deviation).powi(2)).exp();
        Self((0..=reach).map(weight).collect())
    }

    /// The weighted mean about a tick. Beyond its ends a motion goes on as its mirror image about the end.
    fn mean(&self, values: &[Vector2<f64>], at: usize) -> Vector2<f64> {
        let last = values.len() as i64 - 1;
        let value = |tick: i64| {
            let inside = tick.clamp(0, last);
            let mirrored = (2 * inside - tick).clamp(0, last);
            let [inside, mirrored] = [inside, mirrored].map(|tick| values[tick as usize]);
            match tick == tick.clamp(0, last) {
                true => inside,
                false => inside * 2.0 - mirrored,
            }
        };
        let (mut sum, mut weights) = (Vector2::zeros(), 0.0);
        for (away, weight) in self.0.iter().enumerate() {
            let (at, away) = (at as i64, away as i64);
            let both = match away {
                0 => value(at),
                _ => (value(at - away) + value(at + away)) * 0.5,
            };
            let weight = if away == 0 { *weight } else { 2.0 * weight };
            sum += both * weight;
            weights += weight;
        }
        sum / weights
    }
}

#[cfg(test)]
mod tests {
    use super::Window;
    use crate::learning::Filter;
    use nalgebra::Vector2;
    use std::f64::consts::TAU;

    #[test]
    fn the_filter_halves_its_band_without_a_phase_and_keeps_a_line() {
        let (half, period) = (50.0, 1e-4);
        let window = Window::new(Filter::deviation(half) / period);
        let wave = |frequency: f64| -> Vec<Vector2<f64>> {
            let at = |tick: u32| (TAU * frequency * f64::from(tick) * period + 0.3).sin();
            (0..4000).map(|tick| Vector2::new(at(tick), 1.0)).collect()
        };
        for (frequency, gain) in [(1.0, 0.9997), (50.0, 0.5), (200.0, 0.0)] {
            let values = wave(frequency);
            for at in (1000..3000).step_by(7) {
                let wanted = Vector2::new(gain * values[at].x, 1.0);
                let error = (window.mean(&values, at) - wanted).norm();
                assert!(error < 1e-3, "{frequency} Hz: {error}");
            }
        }
        let line: Vec<Vector2<f64>> = (0..500_u32)
            .map(|tick| Vector2::new(f64::from(tick), 2.0 - f64::from(tick)))
            .collect();
        for at in [0, 3, 250, 499] {
            assert!((window.mean(&line, at) - line[at]).norm() < 1e-9, "{at}");
        }
    }
}
