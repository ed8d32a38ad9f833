//! Why a move is refused, and at which point: small enough to be sent.

use crate::safety::State;
use core::fmt;
use fivebar_kinematics::five_bar::{Joint, PoseError, Singularity, WorkspaceViolation};
use fivebar_kinematics::trajectory::{ConstraintViolation, PathError, PathSegmentError, PushError};
use serde::{Deserialize, Serialize};

/// The longest time that one move may take [s]: a day. The count of ticks would suffice for four
/// days, but `f32` resolves the end of a day to 8 ms only.
pub const LONGEST: f32 = 86_400.0;
/// The longest crossing [s].
pub(super) const LONGEST_CROSSING: f32 = 4.0;

/// A move was refused; nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MoveError {
    /// The move's tag.
    pub tag: u32,
    /// Why it was refused.
    pub kind: MoveErrorKind,
    /// The first point of the path that cannot be passed [m], if there is one.
    pub point: Option<[f32; 2]>,
}

/// Why a move was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum MoveErrorKind {
    /// The arm must be armed and not stopping.
    State(State),
    /// The queue is full: try again later.
    Full,
    /// A number is infinite or not a number, or a speed is not positive.
    Number,
    /// The arc starts on its centre, or its ends are not equally far from it.
    Arc,
    /// The tool cannot reach the point.
    Unreachable,
    /// Joint 1 or 4 would leave its limits.
    JointLimit(u8),
    /// Leg 1 or 4 would be too nearly straight or folded.
    LegSingularity(u8),
    /// Links 2 and 3 would be too nearly in line.
    ParallelSingularity,
    /// Joint 1 or 4 does not have the torque to hold the arm there.
    Torque(u8),
    /// The move would take longer than [`LONGEST`], or a crossing longer than 4 s.
    TooLong,
    /// The move does not go on where a timed motion is: in position, velocity and acceleration, or
    /// with a tool that needs a rest.
    Discontinuous,
    /// Joint 1 or 4 would pass its greatest speed, acceleration or torque on a timed move.
    Overload(u8),
    /// The settings do not allow crossings.
    CrossingNotAllowed,
    /// The plan is no crossing of this arm from where it is held.
    Crossing,
    /// Behind the singularity the torques would not show which assembly mode the arm is in.
    IndistinctCrossing,
    /// The torques on both sides of the singularity do not agree.
    CrossingCondition,
    /// A stream of set-points has the arm.
    Streaming,
}

impl MoveError {
    pub(super) fn new(tag: u32, kind: MoveErrorKind) -> Self {
        Self {
            tag,
            kind,
            point: None,
        }
    }

    pub(super) fn on_path(tag: u32, error: &PathError<f32>) -> Self {
        Self {
            tag,
            kind: error.violation.into(),
            point: Some([error.point.x, error.point.y]),
        }
    }

    /// Refuses a move that takes longer than [`LONGEST`] for its length at its speed.
    pub(super) fn unless_in_time(tag: u32, length: f32, speed: f32) -> Result<(), Self> {
        if length.is_finite() && length > LONGEST * speed {
            Err(Self::new(tag, MoveErrorKind::TooLong))
        } else {
            Ok(())
        }
    }
}

fn number(joint: Joint) -> u8 {
    match joint {
        Joint::Joint1 => 1,
        Joint::Joint4 => 4,
    }
}

impl MoveErrorKind {
    pub(super) fn joint_limit(joint: Joint) -> Self {
        Self::JointLimit(number(joint))
    }
}

impl From<Singularity> for MoveErrorKind {
    fn from(singularity: Singularity) -> Self {
        match singularity {
            Singularity::Leg1 => Self::LegSingularity(1),
            Singularity::Leg4 => Self::LegSingularity(4),
            Singularity::Parallel => Self::ParallelSingularity,
        }
    }
}

impl From<ConstraintViolation> for MoveErrorKind {
    fn from(violation: ConstraintViolation) -> Self {
        match violation {
            ConstraintViolation::Workspace(WorkspaceViolation::Pose(PoseError::Unreachable(_))) => {
                Self::Unreachable
            }
            ConstraintViolation::Workspace(WorkspaceViolation::Pose(PoseError::NotFinite))
            | ConstraintViolation::Limits => Self::Number,
            ConstraintViolation::Workspace(
                WorkspaceViolation::Pose(PoseError::Singular(singularity))
                | WorkspaceViolation::Margin(singularity),
            ) => singularity.into(),
            ConstraintViolation::Workspace(WorkspaceViolation::Joint(joint)) => {
                Self::JointLimit(number(joint))
            }
            ConstraintViolation::Torque(joint) => Self::Torque(number(joint)),
            ConstraintViolation::JointSpeed(joint)
            | ConstraintViolation::JointAcceleration(joint)
            | ConstraintViolation::MotionTorque(joint) => Self::Overload(number(joint)),
            // A violation that this version of the protocol does not distinguish.
            _ => Self::Unreachable,
        }
    }
}

impl From<PathSegmentError> for MoveErrorKind {
    fn from(error: PathSegmentError) -> Self {
        match error {
            PathSegmentError::NotFinite | PathSegmentError::ZeroLength => Self::Number,
            PathSegmentError::ZeroRadius | PathSegmentError::RadiusMismatch => Self::Arc,
            _ => Self::Unreachable,
        }
    }
}

impl From<PushError> for MoveErrorKind {
    fn from(error: PushError) -> Self {
        match error {
            PushError::Full => Self::Full,
            PushError::NotFinite => Self::Number,
        }
    }
}

impl fmt::Display for MoveErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(state) => write!(f, "the arm takes no moves while {state:?}"),
            Self::Full => f.write_str("the queue is full"),
            Self::Number => {
                f.write_str("a number is infinite or not a number, or a speed is not positive")
            }
            Self::Arc => {
                f.write_str("the arc starts on its centre, or its ends are not equally far from it")
            }
            Self::Unreachable => f.write_str("the tool cannot reach the point"),
            Self::JointLimit(joint) => write!(f, "joint {joint} would leave its limits"),
            Self::LegSingularity(leg) => {
                write!(f, "leg {leg} would be too nearly straight or folded")
            }
            Self::ParallelSingularity => f.write_str("links 2 and 3 would be too nearly in line"),
            Self::Torque(joint) => {
                write!(
                    f,
                    "joint {joint} does not have the torque to hold the arm there"
                )
            }
            Self::TooLong => write!(
                f,
                "the move would take longer than {LONGEST} s, or a crossing longer than \
                 {LONGEST_CROSSING} s; go faster, or in several moves"
            ),
            Self::Discontinuous => f.write_str(
                "the move does not go on where the timed motion before it is; let that come to rest \
                 first",
            ),
            Self::Overload(joint) => write!(
                f,
                "joint {joint} would pass its greatest speed, acceleration or torque; plan with a \
                 smaller share of the torque"
            ),
            Self::CrossingNotAllowed => f.write_str(
                "the settings do not allow crossings; allow them if the links clear each other",
            ),
            Self::Crossing => f.write_str(
                "the plan is no crossing of this arm from where it is held: with the tool up, forward \
                 through one singularity at its time, by its condition",
            ),
            Self::IndistinctCrossing => f.write_str(
                "behind the singularity the torques would not show which assembly mode the arm is in, \
                 because they differ by less than friction; cross in less time, or go farther behind it",
            ),
            Self::Streaming => f.write_str("a stream of set-points has the arm: end it first"),
            Self::CrossingCondition => f.write_str(
                "the torques on both sides of the singularity do not agree: the motion misses its \
                 condition, or changes too fast there; cross in more time",
            ),
        }
    }
}

impl fmt::Display for MoveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(f)?;
        if let Some([x, y]) = self.point {
            write!(f, " at ({:.3}, {:.3}) mm", 1e3 * x, 1e3 * y)?;
        }
        Ok(())
    }
}

impl core::error::Error for MoveErrorKind {}

impl core::error::Error for MoveError {}
