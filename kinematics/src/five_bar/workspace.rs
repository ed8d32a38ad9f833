//! Where the tool may be: reach, joint limits and a margin from singularities together.

use super::{Joint, JointLimits, Pose, PoseError, Singularity, Tool, WorkingMode};
use crate::{PlanarVector, Scalar};
use core::fmt;
use nalgebra::Vector2;

/// The points an arm may take its tool to in one working mode.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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

impl<S: Scalar> Workspace<S> {
    /// The pose that holds the tool at `t` [m], if it may be there.
    ///
    /// # Errors
    /// The first that fails of reach, joint limits and margin.
    pub fn check(&self, t: Vector2<S>) -> Result<Pose<S>, WorkspaceViolation> {
        let pose = self
            .tool
            .inverse(t, self.mode)
            .map_err(WorkspaceViolation::Pose)?;
        if let Some(limits) = &self.limits {
            limits
                .angles_within(pose.u1.polar_angle(), pose.u4.polar_angle())
                .map_err(WorkspaceViolation::Joint)?;
        }
        let (singularity, sine) = self.tool.nearest_singularity(&pose);
        if sine < self.margin {
            return Err(WorkspaceViolation::Margin(singularity));
        }
        Ok(pose)
    }
}
