//! The outputs of an actuator command that each image has: the brake and the tool.

use super::pins::Brake;
use super::tool::ToolChannel;
use crate::ArmCommand;

/// The outputs.
pub struct CommonOutputs {
    /// The brake's transistor; low: engaged.
    pub brake: Brake,
    /// The tool.
    pub tool: ToolChannel,
}

impl CommonOutputs {
    /// Applies what is theirs of an actuator command.
    #[inline]
    pub fn apply<C>(&mut self, command: &ArmCommand<C>) {
        self.brake.write(!command.brake);
        self.tool.set(command.tool);
    }
}
