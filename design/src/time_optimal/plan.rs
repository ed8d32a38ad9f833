//! The least-time run along one path, with or without a limit of jerk.

use super::demand::DrivenArm;
use super::error::PlanError;
use super::grid::Grid;
use super::jerk;
use super::limits::PlanLimits;
use super::path::PathPiece;
use super::run::{self, Run};

/// Even points of a run, its ends included: 0.5 % of its length apart.
const EVEN_POINTS: usize = 201;
/// Largest gap between two pieces [m].
const GAP: f64 = 1e-6;
/// The least-time run along pieces that follow one another, from rest to rest. It stops where two
/// pieces meet at an angle, and runs through where they have a common tangent. With `jerk`
/// [rad/s³], the law in time is averaged and slowed until the joints' jerks are within it.
///
/// # Errors
/// [`PlanError`], with s where it was found.
pub fn plan(
    arm: &DrivenArm,
    limits: &PlanLimits,
    pieces: &[PathPiece],
    jerk: Option<f64>,
) -> Result<Run, PlanError> {
    check(limits, pieces)?;
    let solved = Grid::new(arm, limits, pieces, EVEN_POINTS)?.solve()?;
    match jerk {
        None => Ok(run::fastest(&solved, EVEN_POINTS)),
        Some(jerk) if jerk > 0.0 => jerk::limited(&solved, EVEN_POINTS, jerk),
        Some(_) => Err(PlanError::Limit),
    }
}

pub(super) fn check(limits: &PlanLimits, pieces: &[PathPiece]) -> Result<(), PlanError> {
    let joints = [limits.torque, limits.speed, limits.acceleration].concat();
    let others = [limits.voltage, limits.tip_speed, limits.tip_acceleration];
    let mut all = joints.into_iter().chain(others.into_iter().flatten());
    let falling = limits.falling_torque.into_iter().flatten();
    let mut falls = falling.map(|limit| limit.standing > 0.0 && limit.slope >= 0.0);
    if !all.all(|limit| limit > 0.0) || !falls.all(|is_sound| is_sound) {
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
