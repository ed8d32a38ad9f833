//! The outputs of an actuator command that each image has: the brake and the tool.

use super::tool::ToolChannel;
use crate::ArmCommand;
use stm32f4xx_hal::gpio::{Output, PC6};

/// The outputs.
pub struct CommonOutputs {
    /// The brake's transistor; low: engaged.
    pub brake: PC6<Output>,
    /// The tool.
    pub tool: ToolChannel,
}

impl CommonOutputs {
    /// Applies what is theirs of an actuator command.
    #[inline]
    pub fn apply<C>(&mut self, command: &ArmCommand<C>) {
        // A pin of this chip cannot fail to be written.
        let _ = self.brake.set_state((!command.brake).into());
        self.tool.set(command.tool);
    }
}
