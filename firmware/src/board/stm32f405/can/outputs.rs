//! The outputs of an actuator command beside the bus: the brake and the tool.

use crate::ArmCommand;
use crate::board::stm32f405::tool::ToolChannel;
use crate::drives::TorqueSetPoint;
use stm32f4xx_hal::gpio::{Output, PC6};

/// The outputs.
pub struct Outputs {
    /// The brake's transistor; low: engaged.
    pub brake: PC6<Output>,
    /// The tool.
    pub tool: ToolChannel,
}

impl Outputs {
    /// Applies an actuator command.
    #[inline]
    pub fn apply(&mut self, command: &ArmCommand<TorqueSetPoint>) {
        // A pin of this chip cannot fail to be written.
        let _ = self.brake.set_state((!command.brake).into());
        self.tool.set(command.tool);
    }
}
