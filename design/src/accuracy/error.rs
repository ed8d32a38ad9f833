//! Why an accuracy analysis has no result.

use super::arm::ArmAccuracyError;
use crate::linkage::dyad::DyadError;
use crate::slider;
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

/// Why a mechanism with tolerances cannot be analysed at a position.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnalysisError {
    /// The five-bar has no pose or no motion there.
    Pose(PoseError),
    /// A worst case cannot be assembled, or the arm is singular there.
    Accuracy(AccuracyError),
    /// The arm with its tolerances has no solution there.
    Arm(ArmAccuracyError),
    /// The slider-driven mechanism has no pose there.
    Slider(slider::PoseError),
    /// The sliders would have to be beyond their travel.
    BeyondTravel {
        /// The left slider [m].
        x2: f64,
        /// The right slider [m].
        x8: f64,
    },
}

impl fmt::Display for AnalysisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pose(error) => error.fmt(f),
            Self::Accuracy(error) => error.fmt(f),
            Self::Arm(error) => error.fmt(f),
            Self::Slider(error) => error.fmt(f),
            Self::BeyondTravel { x2, x8 } => write!(
                f,
                "beyond the sliders' travel: x2 = {:.1} mm, x8 = {:.1} mm",
                1e3 * x2,
                1e3 * x8
            ),
        }
    }
}

impl core::error::Error for AnalysisError {}

impl From<PoseError> for AnalysisError {
    fn from(error: PoseError) -> Self {
        Self::Pose(error)
    }
}

impl From<AccuracyError> for AnalysisError {
    fn from(error: AccuracyError) -> Self {
        Self::Accuracy(error)
    }
}

impl From<ArmAccuracyError> for AnalysisError {
    fn from(error: ArmAccuracyError) -> Self {
        Self::Arm(error)
    }
}

impl From<slider::PoseError> for AnalysisError {
    fn from(error: slider::PoseError) -> Self {
        Self::Slider(error)
    }
}

#[cfg(test)]
mod tests {
    use super::AnalysisError;

    #[test]
    fn places_beyond_the_travel_are_in_millimetres() {
        let error = AnalysisError::BeyondTravel {
            x2: 0.25,
            x8: -0.0306,
        };
        let text = "beyond the sliders' travel: x2 = 250.0 mm, x8 = -30.6 mm";
        assert_eq!(error.to_string(), text);
    }
}
