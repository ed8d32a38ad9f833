//! A run along one path from rest to rest.

use super::demand::{Demand, DrivenArm};
use super::grid::{Grid, Solved};
use super::jerk;
use super::limits::PlanLimits;
use super::path::PathPiece;
use fivebar_kinematics::five_bar::PoseError;
use std::fmt;

/// The run at one of its even places.
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
    /// The run at even places.
    pub samples: Vec<RunSample>,
    /// The time with a limit above 95 % [s].
    pub active_time: f64,
    /// Most by which a limit is passed anywhere, relative.
    pub limit_excess: f64,
}

/// Why a path cannot be run along.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlanError {
    /// The path has no piece.
    Empty,
    /// Piece n, from 0, has no length or a value that is not finite.
    Piece(usize),
    /// Piece n, from 0, does not begin where the last one ends.
    Gap(usize),
    /// A limit is not positive.
    Limit,
    /// The arm has no pose at s, or is in a singularity.
    Pose(f64, PoseError),
    /// The arm passes through a singularity of type 2 near s.
    Crosses(f64),
    /// C′ vanishes near s: the path has a cusp there, or does not move.
    Cusp(f64),
    /// The curvature jumps at s where the arm moves, so its jerk there has no bound.
    CurvatureJump(f64),
    /// Up to s the run has as many pieces and turns as can be planned at once.
    Long(f64),
    /// The limit of jerk cannot be kept.
    Jerk,
    /// At s, gravity and friction need more than a limit allows, so the arm cannot stand there.
    CannotStand(f64),
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the path has no piece"),
            Self::Piece(n) => write!(
                f,
                "piece {} of the path must have finite values and a length above 0",
                n + 1
            ),
            Self::Gap(n) => write!(
                f,
                "piece {} of the path does not begin where piece {n} ends",
                n + 1
            ),
            Self::Limit => f.write_str("every limit must be a positive number"),
            Self::Pose(s, error) => write!(f, "at s = {s:.6}: {error}"),
            Self::Crosses(s) => write!(
                f,
                "near s = {s:.6} the path passes through a singularity: B, C and D in line, or B \
                 meets D (type 2)"
            ),
            Self::Cusp(s) => write!(
                f,
                "near s = {s:.6} the path's derivative vanishes: it has a cusp there or does not \
                 move; divide it there, or describe it by another s"
            ),
            Self::CurvatureJump(s) => write!(
                f,
                "at s = {s:.6} the curvature of the path jumps, so no limit of jerk can be kept; \
                 stop at the corners, or plan without a limit of jerk"
            ),
            Self::Long(s) => write!(
                f,
                "the run is too long to be planned at once: from its beginning to s = {s:.6} it has \
                 as many pieces and turns as are possible; divide it with stops"
            ),
            Self::Jerk => f.write_str(
                "the limit of jerk cannot be kept: with averaging, gravity or friction needs more \
                 torque than the limit, or the motion would be more than 20 times slower",
            ),
            Self::CannotStand(s) => write!(
                f,
                "at s = {s:.6} gravity and friction alone need more than a limit allows"
            ),
        }
    }
}

impl std::error::Error for PlanError {}

/// Even places of a run.
const PLACES: usize = 201;
/// Largest gap between two pieces [m].
const GAP: f64 = 1e-6;
/// The share of a limit above which it counts as active.
pub(super) const ACTIVE: f64 = 0.95;

/// The least-time run along pieces that follow one another, from rest to rest. It stops where two
/// pieces meet at an angle, and runs through where they have a common tangent. With `jerk`
/// [rad/s³], the law in time is averaged and slowed until the joints' jerks are within it.
///
/// # Errors
/// [`PlanError`], with the place.
pub fn plan(
    arm: &DrivenArm,
    limits: &PlanLimits,
    pieces: &[PathPiece],
    jerk: Option<f64>,
) -> Result<Run, PlanError> {
    check(limits, pieces)?;
    let solved = Grid::new(arm, limits, pieces, PLACES)?.solve()?;
    match jerk {
        None => Ok(run(&solved, PLACES)),
        Some(jerk) if jerk > 0.0 => jerk::limited(&solved, PLACES, jerk),
        Some(_) => Err(PlanError::Limit),
    }
}

pub(super) fn check(limits: &PlanLimits, pieces: &[PathPiece]) -> Result<(), PlanError> {
    let joints = [limits.torque, limits.speed, limits.acceleration].concat();
    let others = [limits.voltage, limits.tip_speed, limits.tip_acceleration];
    let mut all = joints.into_iter().chain(others.into_iter().flatten());
    if !all.all(|limit| limit > 0.0) {
        return Err(PlanError::Limit);
    }
    if pieces.is_empty() {
        return Err(PlanError::Empty);
    }
    for (n, piece) in pieces.iter().enumerate() {
        let length = piece.length();
        let ends = [piece.at(0.0), piece.at(length)];
        let finite = ends.iter().all(|end| end.c.norm().is_finite());
        if !(length > 0.0 && length.is_finite() && finite) {
            return Err(PlanError::Piece(n));
        }
        if n > 0 {
            let last = &pieces[n - 1];
            if (last.at(last.length()).c - ends[0].c).norm() > GAP {
                return Err(PlanError::Gap(n));
            }
        }
    }
    Ok(())
}

fn run(solved: &Solved<'_>, places: usize) -> Run {
    let (grid, x) = (&solved.grid, &solved.x[..]);
    let length = grid.length();
    let (mut time, mut active_time, mut most) = (0.0, 0.0, 0.0_f64);
    let mut samples: Vec<RunSample> = Vec::with_capacity(places);
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
        let place = grid.even_place(samples.len());
        if (cell.s - place).abs() < 1e-9 * length {
            samples.push(sample(place, time, x[i], grid.at(cell.start)));
        }
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
        active_time,
        limit_excess: most.max(0.0),
    }
}

/// Keeps s̈ of every place between its means up to the places on either side. At a zero-inertia
/// point s̈ of a cell alternates with the cells' width; its mean does not. Where the means pass a
/// limit, the path bends between two places and s̈ stays as it is.
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
