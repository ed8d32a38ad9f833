//! Where a robot may take its tool.

use super::Robot;
use fivebar_kinematics::five_bar::{GeometryError, Joint, JointLimits, WorkingMode, Workspace};

/// A robot's tool or limits describe no workspace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoWorkspace {
    /// The tool's offset.
    #[error(transparent)]
    Tool(#[from] GeometryError),
    /// The angles of a joint.
    #[error("limits.angle of {0} must be within one and a half turns of 0, the lesser first")]
    Limits(Joint),
}

impl Robot {
    /// Where the robot may take its tool in a working mode: within its joints' limits, and
    /// its margin away from singularities.
    ///
    /// # Errors
    /// A tool on the elbow, or limits that make no sense.
    pub fn workspace(&self, mode: WorkingMode) -> Result<Workspace<f64>, NoWorkspace> {
        let [limits1, limits4] = self.limits.angle;
        let limits = JointLimits::new(limits1, limits4).map_err(NoWorkspace::Limits)?;
        Ok(Workspace {
            tool: self.tool_on_link()?,
            mode,
            limits: Some(limits),
            margin: self.limits.singularity_margin,
        })
    }
}
