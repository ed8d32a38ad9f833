//! A run limited in jerk: the law s(t) averaged over T1 and once more over T2, then slowed.
//!
//! Averages of s(t) stay on the path. With Δ1, Δ2 the differences over T1 and T2,
//!
//! s̄ = Δ1Δ2 ∬s/(T1 T2), ṡ̄ = Δ1Δ2 ∫s/(T1 T2), s̈̄ = Δ1Δ2 s/(T1 T2), s⃛̄ = Δ1Δ2 ṡ/(T1 T2),
//! q⃛ = q′ s⃛ + 3 q″ ṡ s̈ + q‴ ṡ³ (here the difference quotient of q̈ in time).
//!
//! The averages take T1 + T2 longer. Slowing by κ divides inertia and velocity terms by κ²,
//! viscous ones by κ, the jerk by κ³, and leaves gravity and Coulomb friction. T1 and T2 are those
//! of the least κ (T + T1 + T2).

use super::demand::Demand;
use super::grid::{Grid, Solved};
use super::run::{ACTIVE, PlanError, Run, RunSample};

/// Samples in time of the search, and of the result.
const COARSE: usize = 300;
const FINE: usize = 4000;
/// T1 as shares of T, in steps of this factor, and T2 as shares of T1.
const LEAST_SHARE: f64 = 4e-3;
const FACTOR: f64 = 1.25;
const STEPS: usize = 27;
const SECOND: [f64; 5] = [0.05, 0.1, 0.2, 0.4, 0.8];
/// The greatest κ, and the halvings that find it.
const SLOWEST: f64 = 20.0;
const HALVINGS: usize = 40;

/// ∬s, ∫s, s and ṡ in time.
struct TimeLaw {
    t: Vec<f64>,
    at: Vec<[f64; 4]>,
    u: Vec<f64>,
}

/// A motion at one time, before it is slowed.
struct Moment {
    demand: Demand,
    s: f64,
    s_dot: f64,
    s_ddot: f64,
    jerk: [f64; 2],
}

impl TimeLaw {
    fn new(solved: &Solved<'_>) -> Self {
        let x = &solved.x;
        let (mut t, mut now) = (vec![0.0], [0.0; 4]);
        let (mut at, mut u) = (vec![now], Vec::new());
        for (cell, ends) in solved.grid.cells.iter().zip(x.windows(2)) {
            let rate = 0.5 * (ends[1] - ends[0]) / cell.w;
            let dt = 2.0 * cell.w / (ends[0].sqrt() + ends[1].sqrt());
            now = later(now, rate, dt);
            (now[2], now[3]) = (cell.s + cell.w, ends[1].sqrt());
            t.push(t[t.len() - 1] + dt);
            at.push(now);
            u.push(rate);
        }
        Self { t, at, u }
    }

    fn duration(&self) -> f64 {
        self.t[self.t.len() - 1]
    }

    fn at(&self, t: f64) -> [f64; 4] {
        if t <= 0.0 {
            return [0.0; 4];
        }
        let i = self.t.partition_point(|&node| node <= t) - 1;
        let u = self.u.get(i).copied().unwrap_or(0.0);
        later(self.at[i], u, t - self.t[i])
    }

    /// s̄, ṡ̄, s̈̄ and s⃛̄.
    fn averaged(&self, t: f64, [t1, t2]: [f64; 2]) -> [f64; 4] {
        let [now, one, two, both] = [t, t - t1, t - t2, t - t1 - t2].map(|t| self.at(t));
        [0, 1, 2, 3].map(|k| (now[k] - one[k] - two[k] + both[k]) / (t1 * t2))
    }
}

/// ∬s, ∫s, s and ṡ after dt at a constant s̈.
fn later([ss, is, s, v]: [f64; 4], u: f64, dt: f64) -> [f64; 4] {
    [
        ss + dt * (is + dt * (s / 2.0 + dt * (v / 6.0 + dt * u / 24.0))),
        is + dt * (s + dt * (v / 2.0 + dt * u / 6.0)),
        s + dt * (v + dt * u / 2.0),
        v + dt * u,
    ]
}

/// The run of a solved path with joint jerks of at most `jerk` [rad/s³].
pub(super) fn limited(solved: &Solved<'_>, places: usize, jerk: f64) -> Result<Run, PlanError> {
    let (grid, law) = (&solved.grid, TimeLaw::new(solved));
    if let Some(s) = grid.curvature_jump(&solved.x) {
        return Err(PlanError::CurvatureJump(s));
    }
    let duration = law.duration();
    let mut best: Option<(f64, [f64; 2])> = None;
    for step in 0..STEPS {
        let t1 = duration * LEAST_SHARE * FACTOR.powi(step as i32);
        for second in SECOND {
            let windows = [t1, second * t1];
            let total = duration + t1 * (1.0 + second);
            if best.is_some_and(|(least, _)| total >= least) {
                continue;
            }
            let moments = moments(grid, &law, windows, COARSE)?;
            let Some(slowing) = slowing(grid, &moments, jerk) else {
                continue;
            };
            if best.is_none_or(|(least, _)| slowing * total < least) {
                best = Some((slowing * total, windows));
            }
        }
    }
    let (_, windows) = best.ok_or(PlanError::Jerk)?;
    let moments = moments(grid, &law, windows, FINE)?;
    let slowing = slowing(grid, &moments, jerk).ok_or(PlanError::Jerk)?;
    let total = slowing * (duration + windows[0] + windows[1]);
    Ok(run(grid, &moments, places, (slowing, total, jerk)))
}

/// The averaged motion at even times.
fn moments(
    grid: &Grid<'_>,
    law: &TimeLaw,
    windows: [f64; 2],
    count: usize,
) -> Result<Vec<Moment>, PlanError> {
    let dt = (law.duration() + windows[0] + windows[1]) / count as f64;
    let mut moments: Vec<Moment> = Vec::with_capacity(count + 1);
    let mut last: Option<[f64; 2]> = None;
    for k in 0..=count {
        let [s, s_dot, s_ddot, _] = law.averaged(k as f64 * dt, windows);
        let (s, s_dot) = (s.clamp(0.0, grid.length()), s_dot.max(0.0));
        let demand = grid.demand_at(s)?;
        let now = [0, 1].map(|j| demand.q1[j] * s_ddot + demand.q2[j] * s_dot * s_dot);
        let before = last.unwrap_or(now);
        last = Some(now);
        moments.push(Moment {
            demand,
            s,
            s_dot,
            s_ddot,
            jerk: [0, 1].map(|j| (now[j] - before[j]) / dt),
        });
    }
    Ok(moments)
}

/// The least κ ≥ 1 with which every limit holds; none if no κ is enough.
fn slowing(grid: &Grid<'_>, moments: &[Moment], jerk: f64) -> Option<f64> {
    let most = |slow: f64| {
        let used = moments.iter().map(|moment| moment.used(grid, slow, jerk));
        used.fold(0.0, f64::max)
    };
    if most(1.0) <= 1.0 {
        return Some(1.0);
    }
    let (mut low, mut high) = (1.0, SLOWEST);
    if most(high) > 1.0 {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if most(middle) > 1.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
}

impl Moment {
    /// The greatest share of a limit after slowing by κ.
    fn used(&self, grid: &Grid<'_>, slow: f64, jerk: f64) -> f64 {
        let (rate, u) = (self.s_dot / slow, self.s_ddot / (slow * slow));
        let jerks = self
            .jerk
            .map(|value| value.abs() / (slow * slow * slow * jerk));
        let used = grid.used_at(&self.demand, rate * rate, u);
        used.max(jerks[0]).max(jerks[1])
    }
}

/// The slowed run at even places.
fn run(
    grid: &Grid<'_>,
    moments: &[Moment],
    places: usize,
    (slow, total, jerk): (f64, f64, f64),
) -> Run {
    let dt = total / (moments.len() - 1) as f64;
    let used: Vec<f64> = moments.iter().map(|at| at.used(grid, slow, jerk)).collect();
    let active = used.windows(2).filter(|pair| pair[1] > ACTIVE).count();
    let mut samples = Vec::with_capacity(places);
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
        let s_dot = between(from.s_dot, to.s_dot) / slow;
        let s_ddot = between(from.s_ddot, to.s_ddot) / (slow * slow);
        let torques = [from, to].map(|at| {
            let rate = at.s_dot / slow;
            at.demand.torque(rate * rate, at.s_ddot / (slow * slow))
        });
        samples.push(RunSample {
            demand: if share < 0.5 { from.demand } else { to.demand },
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
