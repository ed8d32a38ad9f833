//! A run along one path from rest to rest.

use super::demand::Demand;
use super::grid::{Grid, Solved};
use super::spline::{State, later};

/// The run at one of its even points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSample {
    /// s.
    pub s: f64,
    /// ṡ [1/s times the unit of s].
    pub s_dot: f64,
    /// s̈.
    pub s_ddot: f64,
    /// Time since the beginning of the run [s].
    pub t: f64,
    /// Torque of joint 1 and joint 4 [N·m], with friction.
    pub torque: [f64; 2],
    /// The coefficients of the limits there.
    pub demand: Demand,
}

/// A run along a path from rest to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The greatest s.
    pub length: f64,
    /// Its duration [s].
    pub time: f64,
    /// The run at even points.
    pub samples: Vec<RunSample>,
    /// Its law in time, which [`Run::at`] evaluates.
    pub(super) law: Vec<LawPiece>,
    /// The time with a limit above 95 % [s].
    pub active_time: f64,
    /// Most by which a limit is passed anywhere, relative.
    pub limit_excess: f64,
}

/// A part of the law in time: s⃛ is constant from its beginning to the beginning of the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LawPiece {
    /// When it begins [s].
    pub(super) t: f64,
    /// s, ṡ, s̈ there, and s⃛.
    pub(super) state: State,
}

impl Run {
    /// s, ṡ and s̈ at a time from the beginning of the run [s]: at rest before it and after it.
    pub fn at(&self, t: f64) -> [f64; 3] {
        if t <= 0.0 {
            return [0.0; 3];
        }
        if t >= self.time {
            return [self.length, 0.0, 0.0];
        }
        let next = self.law.partition_point(|piece| piece.t <= t).max(1);
        let Some(piece) = self.law.get(next - 1) else {
            return [0.0; 3];
        };
        let [s, s_dot, s_ddot, _] = later(piece.state, t - piece.t);
        [s.clamp(0.0, self.length), s_dot.max(0.0), s_ddot]
    }
}

/// The share of a limit above which it counts as active.
pub(super) const ACTIVE: f64 = 0.95;

/// The run of a solved path at so many even points.
pub(super) fn fastest(solved: &Solved<'_>, even_points: usize) -> Run {
    let (grid, x) = (&solved.grid, &solved.x[..]);
    let length = grid.length();
    let (mut time, mut active_time, mut most) = (0.0, 0.0, 0.0_f64);
    let mut samples: Vec<RunSample> = Vec::with_capacity(even_points);
    let mut law = Vec::with_capacity(grid.cells.len());
    for (i, cell) in grid.cells.iter().enumerate() {
        let u = 0.5 * (x[i + 1] - x[i]) / cell.w;
        let sample = |s: f64, t: f64, x: f64, at: &Demand| RunSample {
            s,
            s_dot: x.sqrt(),
            s_ddot: u,
            t,
            torque: at.torque(x, u),
            demand: *at,
        };
        let even = grid.even_point(samples.len());
        if (cell.s - even).abs() < 1e-9 * length {
            samples.push(sample(even, time, x[i], grid.at(cell.start)));
        }
        law.push(LawPiece {
            t: time,
            state: [cell.s, x[i].sqrt(), u, 0.0],
        });
        most = most.max(grid.excess(cell, x[i], x[i + 1]));
        let dt = 2.0 * cell.w / (x[i].sqrt() + x[i + 1].sqrt());
        if grid.used(cell.middle, 0.5 * (x[i] + x[i + 1]), u) > ACTIVE {
            active_time += dt;
        }
        time += dt;
        if i + 1 == grid.cells.len() {
            samples.push(sample(length, time, x[i + 1], grid.at(cell.end)));
        }
    }
    smooth(grid, &mut samples);
    Run {
        length,
        time,
        samples,
        law,
        active_time,
        limit_excess: most.max(0.0),
    }
}

/// Keeps s̈ of every point between its means up to the points on either side. At a zero-inertia
/// point s̈ of a cell alternates with the cells' width; its mean does not. Where the means pass a
/// limit, the path bends between two points and s̈ stays as it is.
fn smooth(grid: &Grid<'_>, samples: &mut [RunSample]) {
    let square = |sample: &RunSample| sample.s_dot * sample.s_dot;
    for k in 1..samples.len().saturating_sub(1) {
        let mean =
            |from: &RunSample, to: &RunSample| 0.5 * (square(to) - square(from)) / (to.s - from.s);
        let before = mean(&samples[k - 1], &samples[k]);
        let after = mean(&samples[k], &samples[k + 1]);
        let sample = &mut samples[k];
        let (x, own) = (square(sample), sample.s_ddot);
        let between = own.clamp(before.min(after), before.max(after));
        if grid.used_at(&sample.demand, x, between) <= grid.used_at(&sample.demand, x, own).max(1.0)
        {
            sample.s_ddot = between;
            sample.torque = sample.demand.torque(x, between);
        }
    }
}
