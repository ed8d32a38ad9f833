//! A run limited in jerk: the law s(t) averaged over T1 and once more over T2, then slowed.
//!
//! Averages of s(t) stay on the path ([`Averages`]). q⃛ = q′ s⃛ + 3 q″ ṡ s̈ + q‴ ṡ³.
//!
//! The averages take T1 + T2 longer. At a pace k, inertia and velocity terms are those of pace 1 times
//! k², viscous ones times k, the jerk times k³; gravity and Coulomb friction stay. T1 and T2 are
//! those of the least (T + T1 + T2)/k.

use super::averages::{Averages, TimeLaw};
use super::demand::Demand;
use super::grid::{Grid, Solved};
use super::run::{ACTIVE, PlanError, Run, RunSample};

/// Samples in time of the search, and those that refuse most of its attempts; fewest and most of the result, and those within T2.
const COARSE: [usize; 2] = [25, 300];
const FINE: [f64; 2] = [800.0, 8000.0];
const WITHIN: f64 = 2.0;
/// T1 as shares of T, in steps of this factor, and T2 as shares of T1.
const LEAST_SHARE: f64 = 4e-3;
const FACTOR: f64 = 1.25;
const LAST_STEP: i32 = 26;
const FIRST_SHARE: f64 = 0.2;
const SHARES: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
/// The least pace.
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
pub(super) fn limited(solved: &Solved<'_>, places: usize, jerk: f64) -> Result<Run, PlanError> {
    let (grid, law) = (&solved.grid, TimeLaw::new(solved));
    if let Some(s) = grid.curvature_jump(&solved.x) {
        return Err(PlanError::CurvatureJump(s));
    }
    let search = Search {
        grid,
        law: &law,
        jerk,
        best: None,
    };
    let windows = search.windows().ok_or(PlanError::Jerk)?;
    let slow = law.duration() + windows[0] + windows[1];
    let count = (WITHIN * slow / windows[1]).clamp(FINE[0], FINE[1]);
    let mut moments = Vec::with_capacity(count as usize + 1);
    moments.extend(Moments::new(grid, &law, windows, count as usize));
    let pace = pace(grid, moments.iter(), jerk, SLOWEST).ok_or(PlanError::Jerk)?;
    let total = slow / pace;
    Ok(run(grid, &moments, places, (pace, total, jerk)))
}

/// Seeks T1 and T2 of the least time.
struct Search<'a> {
    grid: &'a Grid<'a>,
    law: &'a TimeLaw,
    jerk: f64,
    /// The least time, with the exponent of T1, T1 and T2.
    best: Option<(f64, i32, [f64; 2])>,
}

impl Search<'_> {
    /// In coarse steps with one share, then around the best; none if no pace is enough.
    fn windows(mut self) -> Option<[f64; 2]> {
        for step in (0..=LAST_STEP).rev().step_by(2) {
            self.attempt(step, FIRST_SHARE);
        }
        let (_, around, _) = self.best?;
        for step in (around - 3..=around + 2).rev() {
            for share in SHARES {
                self.attempt(step, share);
            }
        }
        self.best.map(|(_, _, windows)| windows)
    }

    fn attempt(&mut self, step: i32, share: f64) {
        let duration = self.law.duration();
        let t1 = duration * LEAST_SHARE * FACTOR.powi(step);
        let (windows, total) = ([t1, share * t1], duration + t1 * (1.0 + share));
        let least = self.best.map_or(SLOWEST, |(time, ..)| total / time);
        let mut greatest = Some(1.0).filter(|pace| least < *pace);
        for count in COARSE {
            let moments = Moments::new(self.grid, self.law, windows, count);
            greatest =
                greatest.and_then(|_| pace(self.grid, moments, self.jerk, least.max(SLOWEST)));
        }
        if let Some(pace) = greatest {
            self.best = Some((total / pace, step, windows));
        }
    }
}

/// The greatest pace of at most 1 at which every limit holds; none if it is not above `least`.
fn pace(
    grid: &Grid<'_>,
    moments: impl Iterator<Item = impl std::borrow::Borrow<Moment>>,
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

/// The averaged motion at even times.
struct Moments<'a> {
    grid: &'a Grid<'a>,
    averages: Averages<'a>,
    dt: f64,
    count: usize,
    next: usize,
    cell: usize,
}

impl<'a> Moments<'a> {
    fn new(grid: &'a Grid<'a>, law: &'a TimeLaw, windows: [f64; 2], count: usize) -> Self {
        let averages = Averages::new(law, windows);
        Self {
            grid,
            dt: averages.duration() / count as f64,
            averages,
            count,
            next: 0,
            cell: 0,
        }
    }
}

impl Iterator for Moments<'_> {
    type Item = Moment;

    fn next(&mut self) -> Option<Moment> {
        if self.next > self.count {
            return None;
        }
        let [s, s_dot, s_ddot, s_dddot] = self.averages.at(self.next as f64 * self.dt);
        self.next += 1;
        let (s, s_dot) = (s.clamp(0.0, self.grid.length()), s_dot.max(0.0));
        let (demand, q3) = self.grid.between(s, &mut self.cell);
        let (mixed, cube) = (3.0 * s_dot * s_ddot, s_dot * s_dot * s_dot);
        let jerks = [0, 1].map(|j| demand.q1[j] * s_dddot + demand.q2[j] * mixed + q3[j] * cube);
        Some(Moment {
            demand,
            s,
            s_dot,
            s_ddot,
            jerk: jerks[0].abs().max(jerks[1].abs()),
        })
    }
}

impl Moment {
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

/// The slowed run at even places.
fn run(
    grid: &Grid<'_>,
    moments: &[Moment],
    places: usize,
    (pace, total, jerk): (f64, f64, f64),
) -> Run {
    let dt = total / (moments.len() - 1) as f64;
    let used: Vec<f64> = moments.iter().map(|at| at.used(grid, pace, jerk)).collect();
    let active = used.windows(2).filter(|pair| pair[1] > ACTIVE).count();
    let mut samples = Vec::with_capacity(places);
    let mut cell = 0;
    for k in 0..places {
        let s = grid.even_place(k);
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
            t: if k + 1 == places {
                total
            } else {
                dt * ((i - 1) as f64 + share)
            },
            torque: [0, 1].map(|j| between(torques[0][j], torques[1][j])),
        });
    }
    Run {
        length: grid.length(),
        time: total,
        samples,
        active_time: active as f64 * dt,
        limit_excess: (used.iter().copied().fold(0.0, f64::max) - 1.0).max(0.0),
    }
}
