//! The status of a row as a number; `fivebar.Status` has the names of the numbers.

use fivebar_kinematics::five_bar::{PoseError, Singularity, Unreachable};
use fivebar_report::study::query::QueryErrorKind;
use pyo3::pyfunction;

/// Why a row has no answer.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Problem {
    /// There is none there.
    Pose(PoseError),
    /// The row says neither left nor right.
    NoSide,
    /// The answer is too large for its numbers.
    TooLarge,
}

impl From<PoseError> for Problem {
    fn from(error: PoseError) -> Self {
        Self::Pose(error)
    }
}

/// The row has its answer.
pub(crate) const OK: u8 = 0;

/// All problems; the first has the number 1.
const PROBLEMS: [Problem; 12] = [
    Problem::Pose(PoseError::Unreachable(Unreachable::Leg1TooFar)),
    Problem::Pose(PoseError::Unreachable(Unreachable::Leg1TooNear)),
    Problem::Pose(PoseError::Unreachable(Unreachable::Leg4TooFar)),
    Problem::Pose(PoseError::Unreachable(Unreachable::Leg4TooNear)),
    Problem::Pose(PoseError::Unreachable(Unreachable::ElbowsTooFar)),
    Problem::Pose(PoseError::Unreachable(Unreachable::ElbowsTooNear)),
    Problem::Pose(PoseError::Singular(Singularity::Leg1)),
    Problem::Pose(PoseError::Singular(Singularity::Leg4)),
    Problem::Pose(PoseError::Singular(Singularity::Parallel)),
    Problem::Pose(PoseError::NotFinite),
    Problem::NoSide,
    Problem::TooLarge,
];

impl Problem {
    /// Its number.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Pose(PoseError::Unreachable(why)) => match why {
                Unreachable::Leg1TooFar => 1,
                Unreachable::Leg1TooNear => 2,
                Unreachable::Leg4TooFar => 3,
                Unreachable::Leg4TooNear => 4,
                Unreachable::ElbowsTooFar => 5,
                Unreachable::ElbowsTooNear => 6,
            },
            Self::Pose(PoseError::Singular(which)) => match which {
                Singularity::Leg1 => 7,
                Singularity::Leg4 => 8,
                Singularity::Parallel => 9,
            },
            Self::Pose(PoseError::NotFinite) => 10,
            Self::NoSide => 11,
            Self::TooLarge => 12,
        }
    }

    /// Its kind, as in the errors of `fivebar query`.
    fn kind(self) -> &'static str {
        let kind = match self {
            Self::Pose(error) => error.into(),
            Self::NoSide | Self::TooLarge => QueryErrorKind::Invalid,
        };
        match kind {
            QueryErrorKind::Unreachable => "unreachable",
            QueryErrorKind::Singular => "singular",
            QueryErrorKind::Invalid => "invalid",
        }
    }

    fn reason(self) -> String {
        match self {
            Self::Pose(error) => error.to_string(),
            Self::NoSide => "neither left nor right is given".into(),
            Self::TooLarge => "the numbers given are so large that the answer is not finite".into(),
        }
    }
}

/// Number, kind and reason of every problem.
#[pyfunction]
pub(crate) fn statuses() -> Vec<(u8, &'static str, String)> {
    let row = |problem: Problem| (problem.code(), problem.kind(), problem.reason());
    PROBLEMS.into_iter().map(row).collect()
}
