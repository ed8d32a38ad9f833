//! Why a path cannot be planned.

use fivebar_kinematics::five_bar::PoseError;
use std::fmt;

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
