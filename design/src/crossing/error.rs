//! Why a crossing is refused.

use fivebar_kinematics::five_bar::{Joint, PoseError};
use std::fmt;

/// Why a crossing cannot be planned.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CrossingError {
    /// The time or a limit is not positive and finite.
    Value,
    /// The two ends are the same.
    SamePoint,
    /// At a share of the line, the arm has no pose, or a leg is straight.
    Pose(f64, PoseError),
    /// The line meets no singularity of type 2.
    NoSingularity,
    /// The line meets it more than once.
    SeveralSingularities(usize),
    /// At a share of the line, a joint is outside its range.
    Range(f64, Joint),
    /// At a share of the line, an elbow is within the singularity margin; its sine.
    Elbow(f64, f64),
    /// N·C′/(|N||C′|) is too small: no acceleration along this line satisfies the condition.
    Direction(f64),
    /// No law goes forward from its beginning to its end.
    NoLaw,
    /// A joint needs more torque [N·m] than its limit.
    Torque {
        /// The joint.
        joint: Joint,
        /// What it needs.
        needed: f64,
        /// Its limit.
        limit: f64,
    },
    /// A joint needs more speed [rad/s] than its limit.
    Speed {
        /// The joint.
        joint: Joint,
        /// What it needs.
        needed: f64,
        /// Its limit.
        limit: f64,
    },
    /// A joint needs more acceleration [rad/s²] than its limit.
    Acceleration {
        /// The joint.
        joint: Joint,
        /// What it needs.
        needed: f64,
        /// Its limit.
        limit: f64,
    },
    /// The energy of the motion that no crank drives, and the work of the drag [J].
    TooSlow(f64, f64),
}

impl fmt::Display for CrossingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value => f.write_str("the time and the limits must be positive and finite"),
            Self::SamePoint => f.write_str("the crossing ends where it begins: give another end"),
            Self::Pose(s, error) => write!(f, "at {:.1} % of the line: {error}", 100.0 * s),
            Self::NoSingularity => f.write_str(
                "the line meets no singularity of type 2 in this working mode: there is nothing to \
                 cross",
            ),
            Self::SeveralSingularities(n) => write!(
                f,
                "the line meets a singularity of type 2 {n} times: choose one that meets it once"
            ),
            Self::Range(s, joint) => {
                write!(
                    f,
                    "at {:.1} % of the line {joint} is outside limits.angle",
                    100.0 * s
                )
            }
            Self::Elbow(s, sine) => write!(
                f,
                "at {:.1} % of the line an elbow is within limits.singularity_margin: |sin| = \
                 {sine:.3}",
                100.0 * s
            ),
            Self::Direction(share) => write!(
                f,
                "the line is almost perpendicular to N (cosine {share:.3}): no acceleration along \
                 it satisfies the condition N·a + f0 = 0; turn the line towards N"
            ),
            Self::NoLaw => f.write_str(
                "no motion along the line goes forward all the way and satisfies the condition; \
                 choose another time",
            ),
            Self::Torque {
                joint,
                needed,
                limit,
            } => {
                write!(
                    f,
                    "{joint} needs {needed:.3} N·m of {limit:.3}: choose a longer time"
                )
            }
            Self::Speed {
                joint,
                needed,
                limit,
            } => {
                write!(
                    f,
                    "{joint} needs {needed:.1} rad/s of {limit:.1}: choose a longer time"
                )
            }
            Self::Acceleration {
                joint,
                needed,
                limit,
            } => {
                write!(
                    f,
                    "{joint} needs {needed:.0} rad/s² of {limit:.0}: choose a longer time"
                )
            }
            Self::TooSlow(energy, work) => write!(
                f,
                "too slow for crossing.drag: the arm crosses with {:.3} mJ, the drag takes {:.3} \
                 mJ; choose a shorter time, or lift the tool",
                1e3 * energy,
                1e3 * work
            ),
        }
    }
}

impl std::error::Error for CrossingError {}
