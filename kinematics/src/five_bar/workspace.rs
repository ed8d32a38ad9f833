//! The positions that the tool may have, by reach, joint limits and a margin from singularities.

use super::{Joint, JointLimits, Pose, PoseError, Singularity, Tool, WorkingMode};
use crate::{PlanarVector, Scalar};
use core::fmt;
use nalgebra::Vector2;

/// The points an arm may take its tool to in one working mode.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, JointLimits, Side, Tool, WorkingMode, Workspace};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.16, 0.10, 0.08])?;
/// let workspace = Workspace {
///     tool: Tool::new(geometry, Vector2::zeros())?,
///     mode: WorkingMode::new(Side::Right, Side::Left),
///     limits: Some(JointLimits::new([0.5, 3.2], [-0.1, 2.6])?), // rad
///     margin: 0.15,
/// };
/// assert!(workspace.check(Vector2::new(0.04, 0.18)).is_ok());
/// assert!(workspace.check(Vector2::new(0.04, 0.30)).is_err());
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workspace<S> {
    /// The arm and its tool.
    pub tool: Tool<S>,
    /// The inverse branch of the tool.
    pub mode: WorkingMode,
    /// Limits of the driven joints, if they have any.
    pub limits: Option<JointLimits<S>>,
    /// Least |sin| of the angles at the elbows (leg 1 being A–B–T) and at C.
    pub margin: S,
}

/// Why a point lies outside a workspace.
///
/// ```
/// use fivebar_kinematics::five_bar::{Geometry, Side, Singularity, Tool, WorkingMode};
/// use fivebar_kinematics::five_bar::{Workspace, WorkspaceViolation};
/// use fivebar_kinematics::nalgebra::Vector2;
///
/// let geometry = Geometry::new([0.10_f64, 0.16, 0.20, 0.10, 0.08])?;
/// let tool = Tool::new(geometry, Vector2::zeros())?;
/// let mode = WorkingMode::new(Side::Right, Side::Left);
/// let workspace = Workspace { tool, mode, limits: None, margin: 0.15 };
/// // 0.2 mm before leg 1 is straight: reachable, but within the margin.
/// let violation = workspace.check(Vector2::new(0.0, 0.2598)).unwrap_err();
/// assert_eq!(violation, WorkspaceViolation::Margin(Singularity::Leg1));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum WorkspaceViolation {
    /// There is no pose.
    Pose(PoseError),
    /// A driven joint would leave its limits.
    Joint(Joint),
    /// The pose is nearer than the margin to this singularity.
    Margin(Singularity),
}

impl fmt::Display for WorkspaceViolation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pose(error) => error.fmt(f),
            Self::Joint(joint) => write!(f, "{joint} would leave its limits"),
            Self::Margin(singularity) => write!(f, "too near a singularity: {singularity}"),
        }
    }
}

impl core::error::Error for WorkspaceViolation {}

impl From<PoseError> for WorkspaceViolation {
    fn from(error: PoseError) -> Self {
        Self::Pose(error)
    }
}

impl<S: Scalar> Workspace<S> {
    /// The pose with the tool at `t` [m], if the workspace contains it.
    ///
    /// # Errors
    /// The first that fails of reach, joint limits and margin.
    pub fn check(&self, t: Vector2<S>) -> Result<Pose<S>, WorkspaceViolation> {
        let pose = self.tool.inverse(t, self.mode)?;
        if let Some(limits) = &self.limits {
            limits
                .angles_within(pose.u1.polar_angle(), pose.u4.polar_angle())
                .map_err(|error| WorkspaceViolation::Joint(error.joint()))?;
        }
        let (singularity, sine) = self.tool.nearest_singularity(&pose);
        if sine < self.margin {
            return Err(WorkspaceViolation::Margin(singularity));
        }
        Ok(pose)
    }
}
