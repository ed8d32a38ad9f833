//! A run limited in jerk: the law s(t) averaged over T1 and once more over T2, then slowed.
//!
//! Averages of s(t) stay on the path ([`Averages`]). q⃛ = q′ s⃛ + 3 q″ ṡ s̈ + q‴ ṡ³.
//!
//! The averages take T1 + T2 longer. At a pace k, inertia and velocity terms are those of pace 1 times
//! k², viscous ones times k, the jerk times k³; gravity and Coulomb friction stay. T1 and T2 are
//! those of the least (T + T1 + T2)/k.

use super::averages::{Averages, TimeLaw};
use super::demand::Demand;
use super::error::PlanError;
use super::grid::{Grid, Solved};
use super::run::{ACTIVE, LawPiece, Run, RunSample};
use std::borrow::Borrow;

/// How many even samples in time stand for a run.
struct Sampling {
    /// The fewest.
    fewest: usize,
    /// Those per cell of the path, if that gives more.
    per_cell: f64,
}

/// Even samples in time with which an attempt of the search begins: most attempts are refused by
/// these few, which takes little time.
const FIRST_SAMPLES: usize = 25;
/// Even samples in time of an attempt that the first samples do not refuse.
const COARSE: Sampling = Sampling {
    fewest: 300,
    per_cell: 0.25,
};
/// Even samples in time of the result: about one a cell, as the path itself is resolved.
const FINE: Sampling = Sampling {
    fewest: 800,
    per_cell: 1.0,
};
/// The share of the limit of jerk above which a jump of s̈ by itself, averaged over T1, is sampled.
/// Smaller ones hardly change the greatest jerk.
const NOTED: f64 = 0.1;
/// The shortest T1, as a share of T.
const LEAST_SHARE: f64 = 4e-3;
/// The factor from one T1 of the search to the next.
const FACTOR: f64 = 1.25;
/// The number of the longest T1 of the search: 4e-3·1.25²⁶ T = 1.3 T.
const LAST_STEP: i32 = 26;
/// T2 as a share of T1 while T1 is searched: the middle one of [`SHARES`].
const FIRST_SHARE: f64 = 0.2;
/// T2 as shares of T1 that are tried about the best T1, each twice the last. The averages over T1
/// and T2 commute, so shares above 1 would repeat those below.
const SHARES: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
/// The least pace: a run that would be more than 20 times slower is refused.
const SLOWEST: f64 = 0.05;

/// A motion at one time, at pace 1.
struct Moment {
    demand: Demand,
    s: f64,
    s_dot: f64,
    s_ddot: f64,
    jerk: f64,
}

/// The run of a solved path with joint jerks of at most `jerk` [rad/s³].
pub(super) fn limited(
    solved: &Solved<'_>,
    even_points: usize,
    jerk: f64,
) -> Result<Run, PlanError> {
    let grid = &solved.grid;
    if let Some(s) = grid.curvature_jump(&solved.x) {
        return Err(PlanError::CurvatureJump(s));
    }
    let law = TimeLaw::new(solved);
    let jumps = Jump::all(grid, &law);
    let search = Search {
        grid,
        law: &law,
        jumps: &jumps,
        jerk,
        best: None,
    };
    let windows = search.windows().ok_or(PlanError::Jerk)?;
    let averaged = Averaged {
        grid,
        law: &law,
        windows,
    };
    let even: Vec<Moment> = averaged.even(FINE.count(grid)).collect();
    let jumps: Vec<Moment> = averaged.at_jumps(&jumps, jerk).collect();
    let all = || even.iter().chain(&jumps);
    let pace = pace(grid, all(), jerk, SLOWEST).ok_or(PlanError::Jerk)?;
    let used = |at: &Moment| at.used(grid, pace, jerk);
    let excess = all().map(used).fold(0.0, f64::max) - 1.0;
    let active = even[1..].iter().filter(|at| used(at) > ACTIVE).count();
    let time = averaged.duration() / pace;
    Ok(Run {
        length: grid.length(),
        time,
        samples: samples(grid, &even, even_points, (pace, time)),
        law: law_of(&even, pace, time),
        active_time: time * active as f64 / (even.len() - 1) as f64,
        limit_excess: excess.max(0.0),
    })
}

impl Sampling {
    /// The number of samples for a path in these cells.
    fn count(&self, grid: &Grid<'_>) -> usize {
        let by_cells = (self.per_cell * grid.cells.len() as f64) as usize;
        self.fewest.max(by_cells)
    }
}

/// A time at which s̈ jumps.
struct Jump {
    t: f64,
    /// By which a joint's acceleration jumps there, the most of both [rad/s²].
    acceleration: f64,
}

impl Jump {
    /// Those at the nodes of a law.
    fn all(grid: &Grid<'_>, law: &TimeLaw) -> Vec<Self> {
        let starts = grid.cells.iter().map(|cell| cell.start);
        let last = grid.cells.last().map(|cell| cell.end);
        let jumps = starts.chain(last).zip(law.jumps());
        let jump = |(node, (t, [before, after])): (usize, (f64, [f64; 2]))| {
            let [one, four] = grid.at(node).q1.map(f64::abs);
            Self {
                t,
                acceleration: one.max(four) * (after - before).abs(),
            }
        };
        jumps.map(jump).collect()
    }
}

/// Seeks T1 and T2 of the least time.
struct Search<'a> {
    grid: &'a Grid<'a>,
    law: &'a TimeLaw,
    jumps: &'a [Jump],
    jerk: f64,
    best: Option<Attempt>,
}

/// An attempt of the search that keeps every limit.
#[derive(Clone, Copy)]
struct Attempt {
    /// (T + T1 + T2)/k [s].
    time: f64,
    /// The number of T1, from 0.
    step: i32,
    /// T1, T2 [s].
    windows: [f64; 2],
}

impl Search<'_> {
    /// Where the greatest jump takes the jerk to its limit, because a good time refuses most of the others soon; in
    /// coarse steps with one share; then around the best. None if no pace is enough.
    fn windows(mut self) -> Option<[f64; 2]> {
        let jump = self.jumps.iter().map(|jump| jump.acceleration);
        let t1 = jump.fold(0.0, f64::max) / self.jerk;
        let share = t1 / (LEAST_SHARE * self.law.duration());
        let step = (share.ln() / FACTOR.ln()).round() as i32;
        self.attempt(step.clamp(0, LAST_STEP), FIRST_SHARE);
        for step in (0..=LAST_STEP).rev().step_by(2) {
            self.attempt(step, FIRST_SHARE);
        }
        let around = self.best?.step;
        for step in (around - 3..=around + 2).rev() {
            for share in SHARES {
                self.attempt(step, share);
            }
        }
        self.best.map(|best| best.windows)
    }

    fn attempt(&mut self, step: i32, share: f64) {
        let (grid, jerk) = (self.grid, self.jerk);
        let t1 = self.law.duration() * LEAST_SHARE * FACTOR.powi(step);
        let averaged = Averaged {
            grid,
            law: self.law,
            windows: [t1, share * t1],
        };
        let total = averaged.duration();
        let least = self.best.map_or(0.0, |best| total / best.time);
        if least >= 1.0 {
            return;
        }
        let least = least.max(SLOWEST);
        let coarse = averaged
            .even(FIRST_SAMPLES)
            .chain(averaged.at_jumps(self.jumps, jerk))
            .chain(averaged.even(COARSE.count(grid)));
        if let Some(pace) = pace(grid, coarse, jerk, least) {
            self.best = Some(Attempt {
                time: total / pace,
                step,
                windows: averaged.windows,
            });
        }
    }
}

/// The greatest pace of at most 1 at which every limit holds; none if it is not above `least`.
fn pace(
    grid: &Grid<'_>,
    moments: impl Iterator<Item = impl Borrow<Moment>>,
    jerk: f64,
    least: f64,
) -> Option<f64> {
    let mut pace = 1.0;
    for moment in moments {
        pace = moment.borrow().pace(grid, pace, jerk);
        if pace <= least {
            return None;
        }
    }
    Some(pace)
}

/// The averages of a law over T1 and T2, as motions of the arm.
struct Averaged<'a> {
    grid: &'a Grid<'a>,
    law: &'a TimeLaw,
    windows: [f64; 2],
}

impl Averaged<'_> {
    /// The duration at pace 1 [s].
    fn duration(&self) -> f64 {
        self.law.duration() + self.windows[0] + self.windows[1]
    }

    /// The motion at even times.
    fn even(&self, count: usize) -> impl Iterator<Item = Moment> {
        let dt = self.duration() / count as f64;
        self.at((0..=count).map(move |k| k as f64 * dt))
    }

    /// The motion where s⃛ bends because of jumps that a limit of jerk [rad/s³] can notice: it is greatest
    /// at such times.
    fn at_jumps(&self, jumps: &[Jump], jerk: f64) -> impl Iterator<Item = Moment> {
        let [t1, t2] = self.windows;
        let least = NOTED * jerk * t1;
        let shifts = [0.0, t2, t1, t1 + t2].into_iter();
        shifts.flat_map(move |shift| {
            let noted = jumps.iter().filter(move |jump| jump.acceleration >= least);
            self.at(noted.map(move |jump| jump.t + shift))
        })
    }

    /// The motion at rising times.
    fn at(&self, times: impl Iterator<Item = f64>) -> impl Iterator<Item = Moment> {
        let mut averages = Averages::new(self.law, self.windows);
        let mut cell = 0;
        times.map(move |t| Moment::new(self.grid, averages.at(t), &mut cell))
    }
}

impl Moment {
    /// The motion of s̄ and its derivatives; `cell` is as in [`Grid::between`].
    fn new(grid: &Grid<'_>, [s, s_dot, s_ddot, s_dddot]: [f64; 4], cell: &mut usize) -> Self {
        let (s, s_dot) = (s.clamp(0.0, grid.length()), s_dot.max(0.0));
        let (demand, q3) = grid.between(s, cell);
        let (mixed, cube) = (3.0 * s_dot * s_ddot, s_dot * s_dot * s_dot);
        let jerks = [0, 1].map(|j| demand.q1[j] * s_dddot + demand.q2[j] * mixed + q3[j] * cube);
        Self {
            demand,
            s,
            s_dot,
            s_ddot,
            jerk: jerks[0].abs().max(jerks[1].abs()),
        }
    }

    /// The greatest pace of at most `most` at which every limit holds.
    fn pace(&self, grid: &Grid<'_>, most: f64, jerk: f64) -> f64 {
        if self.used(grid, most, jerk) <= 1.0 {
            return most;
        }
        let of_limits = grid.pace(&self.demand, self.s_dot, self.s_ddot);
        most.min(of_limits).min((jerk / self.jerk).cbrt())
    }

    /// The greatest share of a limit at a pace.
    fn used(&self, grid: &Grid<'_>, pace: f64, jerk: f64) -> f64 {
        let (rate, u) = (self.s_dot * pace, self.s_ddot * (pace * pace));
        let used = grid.used_at(&self.demand, rate * rate, u);
        used.max(self.jerk * (pace * pace * pace) / jerk)
    }
}

/// The slowed run in time: s̈ is linear between its moments.
fn law_of(moments: &[Moment], pace: f64, total: f64) -> Vec<LawPiece> {
    let dt = total / (moments.len() - 1) as f64;
    let pairs = moments.windows(2).enumerate();
    pairs
        .map(|(k, ends)| {
            let [from, to] = [&ends[0], &ends[1]].map(|at| at.s_ddot * pace * pace);
            LawPiece {
                t: dt * k as f64,
                state: [ends[0].s, ends[0].s_dot * pace, from, (to - from) / dt],
            }
        })
        .collect()
}

/// The slowed run at even points, between its moments at even times.
fn samples(
    grid: &Grid<'_>,
    moments: &[Moment],
    even_points: usize,
    (pace, total): (f64, f64),
) -> Vec<RunSample> {
    let dt = total / (moments.len() - 1) as f64;
    let mut samples = Vec::with_capacity(even_points);
    let mut cell = 0;
    for k in 0..even_points {
        let s = grid.even_point(k);
        let i = moments
            .partition_point(|at| at.s < s)
            .clamp(1, moments.len() - 1);
        let (from, to) = (&moments[i - 1], &moments[i]);
        let share = if k == 0 {
            0.0
        } else {
            ((s - from.s) / (to.s - from.s)).clamp(0.0, 1.0)
        };
        let between = |from: f64, to: f64| from + share * (to - from);
        let s_dot = between(from.s_dot, to.s_dot) * pace;
        let s_ddot = between(from.s_ddot, to.s_ddot) * (pace * pace);
        let torques = [from, to].map(|at| {
            let rate = at.s_dot * pace;
            at.demand.torque(rate * rate, at.s_ddot * (pace * pace))
        });
        samples.push(RunSample {
            demand: grid.between(s, &mut cell).0,
            s,
            s_dot,
            s_ddot,
            t: if k + 1 == even_points {
                total
            } else {
                dt * ((i - 1) as f64 + share)
            },
            torque: [0, 1].map(|j| between(torques[0][j], torques[1][j])),
        });
    }
    samples
}
