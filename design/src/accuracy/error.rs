//! Why an accuracy analysis has no result.

use crate::linkage::dyad::DyadError;
use core::fmt;
use fivebar_kinematics::five_bar::PoseError;

/// Why an accuracy analysis has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum AccuracyError {
    /// The loops do not close near the guess.
    Unclosed,
    /// The mechanism is singular: a small error may have an effect of any size.
    Singular,
    /// The five-bar has no such pose.
    Pose(PoseError),
    /// A dyad cannot be assembled.
    Dyad(DyadError),
}

impl fmt::Display for AccuracyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unclosed => f.write_str("the loops cannot be closed near the guess"),
            Self::Singular => f.write_str("the mechanism is singular here"),
            Self::Pose(error) => error.fmt(f),
            Self::Dyad(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for AccuracyError {}

impl From<PoseError> for AccuracyError {
    fn from(error: PoseError) -> Self {
        Self::Pose(error)
    }
}

impl From<DyadError> for AccuracyError {
    fn from(error: DyadError) -> Self {
        Self::Dyad(error)
    }
}
