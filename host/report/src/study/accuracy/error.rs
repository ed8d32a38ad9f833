//! Why an accuracy study has no result.

use fivebar_design::accuracy::AnalysisError;
use fivebar_design::accuracy::five_bar::MapError;

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
        reason: AnalysisError,
    },
    /// A position on a job's path cannot be analysed.
    #[error("line {line}: {error}")]
    Line {
        /// The line of the job.
        line: u32,
        /// The position and the reason.
        error: Box<AccuracyStudyError>,
    },
    /// The job changes the working mode, and the analysis is of one mode.
    #[error(
        "line {0} changes the working mode, and the analysis is of one mode: analyse the parts"
    )]
    ChangeOfMode(u32),
    /// The tool is beside C, and the analysis is of C.
    #[error(
        "the tool is beside C (`offset` of [tool]), and the analysis is of C: leave the offset out of the robot file, and give \
         the path of C"
    )]
    ToolOffset,
    /// The job has no path.
    #[error("the job has no path: add a motion after its first point")]
    NoPath,
    /// The region has no area.
    #[error("the region is empty: give X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1")]
    EmptyRegion,
    /// The region has no position that can be analysed.
    #[error("no position of the region is within reach and outside the singularity margin")]
    NothingReached,
    /// No choice of classes keeps the deviation [m].
    #[error(
        "even with the finest classes the deviation exceeds {0} m somewhere: make the region smaller with \
         --region, or add finer classes"
    )]
    TooCoarse(f64),
    /// The linkage cannot be solved at an instant [s].
    #[error("at {time} s: {explanation}")]
    Linkage {
        /// The instant [s].
        time: f64,
        /// The element that cannot be solved, by name, and the reason.
        explanation: String,
    },
}

impl From<MapError> for AccuracyStudyError {
    fn from(error: MapError) -> Self {
        match error {
            MapError::EmptyRegion => Self::EmptyRegion,
            // `NothingReached`, and any reason that is added later.
            _ => Self::NothingReached,
        }
    }
}
