//! The workspace of a robot.

use super::Robot;
use fivebar_kinematics::five_bar::{GeometryError, Joint, JointLimits, WorkingMode, Workspace};

/// Why a robot has no workspace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WorkspaceError {
    /// The tool's offset is not valid.
    #[error(transparent)]
    Tool(#[from] GeometryError),
    /// The angle limits of a joint are not valid.
    #[error("limits.angle of {0} must be within one and a half turns of 0, the smaller first")]
    Limits(Joint),
}

impl Robot {
    /// The workspace of a working mode: within the joint limits and outside the singularity
    /// margin.
    ///
    /// # Errors
    /// The tool is at the elbow, or the limits are not valid.
    pub fn workspace(&self, mode: WorkingMode) -> Result<Workspace<f64>, WorkspaceError> {
        let [limits1, limits4] = self.limits.angle;
        let limits = JointLimits::new(limits1, limits4)
            .map_err(|error| WorkspaceError::Limits(error.joint()))?;
        Ok(Workspace {
            tool: self.tool_on_link()?,
            mode,
            limits: Some(limits),
            margin: self.limits.singularity_margin,
        })
    }
}
