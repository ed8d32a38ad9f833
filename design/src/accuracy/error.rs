//! Why an accuracy cannot be told.

use crate::linkage::dyad::DyadError;
use core::fmt;
use fivebar_kinematics::five_bar::PoseError;

/// Why an analysis has no answer here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum AccuracyError {
    /// The loops do not close near the guess.
    Unclosed,
    /// The mechanism is singular: an error of any size may follow from a small one.
    Singular,
    /// The five-bar's pose cannot be had.
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
