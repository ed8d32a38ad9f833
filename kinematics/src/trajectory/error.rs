//! Why a path or a move is not accepted.

use crate::Scalar;
use crate::five_bar::{Joint, PoseError, WorkspaceViolation};
use core::fmt;
use nalgebra::Vector2;

/// The constraint that a path violates.
///
/// ```
/// use fivebar_kinematics::five_bar::{Singularity, WorkspaceViolation};
/// use fivebar_kinematics::trajectory::ConstraintViolation;
///
/// let violation = ConstraintViolation::from(WorkspaceViolation::Margin(Singularity::Leg1));
/// assert_eq!(
///     violation.to_string(),
///     "too near a singularity: leg A–B–C is straight or folded (type 1)",
/// );
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ConstraintViolation {
    /// The tool would be outside the workspace.
    Workspace(WorkspaceViolation),
    /// The joint's greatest torque cannot hold the arm there, at any speed.
    Torque(Joint),
    /// A speed or a limit given is not a positive finite number.
    Limits,
    /// The joint would be faster than its limit.
    JointSpeed(Joint),
    /// The joint would accelerate more than its limit.
    JointAcceleration(Joint),
    /// The motion needs more than the joint's greatest torque.
    MotionTorque(Joint),
}

/// The first point found on a path that violates a constraint.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, Tool, WorkingMode, Workspace};
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::{Envelope, MotionLimits, PathSegment};
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let (tool, mode) = (Tool::new(geometry, Vector2::zeros())?, WorkingMode::new(Side::Right, Side::Left));
/// let envelope = Envelope {
///     workspace: Workspace { tool, mode, limits: None, margin: 0.15 },
///     joint_speed: [20.0; 2],
///     joint_acceleration: [2000.0; 2],
///     torque: None,
///     tool_motion: MotionLimits { speed: 1.0, acceleration: 10.0, jerk: 1000.0 },
///     corner_tolerance: 0.0,
/// };
/// // The line leads out of reach: the error says where on it.
/// let line = PathSegment::line(Vector2::new(0.04, 0.18), Vector2::new(0.04, 0.35))?;
/// let error = envelope.check(&line, 0.3).unwrap_err();
/// assert!(error.fraction > 0.2 && error.fraction < 0.5);
/// assert!((error.point - line.at(error.fraction * 0.17).position).norm() < 1e-12);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathError<S> {
    /// The place along the path, as a share 0…1 of its length.
    pub fraction: S,
    /// The tool there [m].
    pub point: Vector2<S>,
    /// The violated constraint.
    pub violation: ConstraintViolation,
}

/// Why a move is not accepted.
///
/// ```
/// use fivebar_kinematics::nalgebra::Vector2;
/// use fivebar_kinematics::trajectory::{LookaheadPlanner, PushError};
///
/// let mut planner = LookaheadPlanner::<f64, 4>::new();
/// let place = Vector2::new(0.04, 0.18); // m
/// assert_eq!(planner.push_dwell(place, -1.0, 0), Err(PushError::NotFinite));
/// let mut dwells = 0;
/// let refusal = loop {
///     match planner.push_dwell(place, 0.5, 1) { // s
///         Ok(()) => dwells += 1,
///         Err(error) => break error,
///     }
/// };
/// assert_eq!((dwells, refusal), (4, PushError::Full));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PushError {
    /// The queue is full: take segments out first.
    Full,
    /// A limit is not a positive finite number, or a length or duration is not finite or is
    /// negative.
    NotFinite,
}

impl fmt::Display for ConstraintViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Workspace(violation) => violation.fmt(f),
            Self::Torque(joint) => write!(f, "{joint} has not the torque to hold the arm"),
            Self::Limits => f.write_str("a speed or limit is not a positive finite number"),
            Self::JointSpeed(joint) => write!(f, "{joint} would pass its greatest speed"),
            Self::JointAcceleration(joint) => {
                write!(f, "{joint} would pass its greatest acceleration")
            }
            Self::MotionTorque(joint) => write!(f, "{joint} would pass its greatest torque"),
        }
    }
}

impl core::error::Error for ConstraintViolation {}

impl From<WorkspaceViolation> for ConstraintViolation {
    fn from(violation: WorkspaceViolation) -> Self {
        Self::Workspace(violation)
    }
}

impl From<PoseError> for ConstraintViolation {
    fn from(error: PoseError) -> Self {
        Self::Workspace(WorkspaceViolation::Pose(error))
    }
}

impl<S: Scalar> fmt::Display for PathError<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.fraction.to_f64();
        let [x, y] = [self.point.x, self.point.y].map(|coordinate| 1e3 * coordinate.to_f64());
        write!(
            f,
            "at {share:.1} % of the path, ({x:.3}, {y:.3}) mm: {}",
            self.violation
        )
    }
}

impl<S: Scalar> core::error::Error for PathError<S> {}

impl fmt::Display for PushError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Full => "the queue is full",
            Self::NotFinite => {
                "a limit is not positive and finite, or a length or duration is negative or not finite"
            }
        })
    }
}

impl core::error::Error for PushError {}

/// What a check gives, with θ1 and θ4 at the end [rad] if the workspace limits them.
pub(super) type WithJoints<T, S> = Result<(T, Option<[S; 2]>), PathError<S>>;
