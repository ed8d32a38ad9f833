//! Why an accuracy study has no result.

use fivebar_design::accuracy::AccuracyError;
use fivebar_design::accuracy::arm::ArmAccuracyError;
use fivebar_design::slider;
use fivebar_kinematics::five_bar::PoseError;

/// Why a mechanism cannot be analysed at a position.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlaceError {
    /// The five-bar has no pose or no motion there.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A worst case cannot be assembled, or the arm is singular there.
    #[error(transparent)]
    Accuracy(#[from] AccuracyError),
    /// The arm with its tolerances has no solution there.
    #[error(transparent)]
    Arm(#[from] ArmAccuracyError),
    /// The slider-driven mechanism has no pose there.
    #[error(transparent)]
    Slider(#[from] slider::PoseError),
    /// The sliders would have to be beyond their travel [m].
    #[error("beyond the sliders' travel: x2 = {x2:.4} m, x8 = {x8:.4} m")]
    BeyondTravel {
        /// The left slider [m].
        x2: f64,
        /// The right slider [m].
        x8: f64,
    },
}

/// Why an accuracy study has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AccuracyStudyError {
    /// The mechanism cannot be analysed at a position [m].
    #[error("at ({}, {}) m: {reason}", .place[0], .place[1])]
    Place {
        /// The position of C or P [m].
        place: [f64; 2],
        /// The reason.
        reason: PlaceError,
    },
    /// A position on a job's path cannot be analysed.
    #[error("line {line}: {error}")]
    Line {
        /// The line of the job.
        line: u32,
        /// The position and the reason.
        error: Box<AccuracyStudyError>,
    },
    /// The job has no path.
    #[error("the job has no path: add a motion after its first point")]
    NoPath,
    /// The region has no area.
    #[error("the region is empty: give X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1")]
    EmptyRegion,
    /// The region has no position that can be analysed.
    #[error("no position of the region is within reach and outside the singularity margin")]
    NothingReached,
    /// The linkage cannot be solved at an instant [s].
    #[error("at {time} s: {explanation}")]
    Linkage {
        /// The instant [s].
        time: f64,
        /// The element that cannot be solved, by name, and the reason.
        explanation: String,
    },
}
