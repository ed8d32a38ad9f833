//! The result of one tick of the emulated board.

use crate::drives::BrushedCommand;
use crate::safety::{Fault, State};
use crate::{ArmCommand, Status};
use serde::{Deserialize, Serialize};

/// The result of one tick: the actuator command, and the state and estimates behind it. Two
/// controllers whose results have the same bits in every tick run identically.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepResult<C = BrushedCommand> {
    /// The actuator command.
    pub command: ArmCommand<C>,
    /// Ticks since the reset.
    pub tick: u32,
    /// What the controller is doing after the tick.
    pub state: State,
    /// The latched fault.
    pub fault: Option<Fault>,
    /// θ̂1, θ̂4 [rad].
    pub angle: [f32; 2],
    /// ω̂1, ω̂4 [rad/s].
    pub velocity: [f32; 2],
    /// The tool [m].
    pub tool: Option<[f32; 2]>,
    /// Current set-points [A].
    pub current_demand: [f32; 2],
    /// Instructions that the tick took; 0 where they are not counted.
    pub instructions: u32,
}

impl<C> StepResult<C> {
    /// The result of the tick that gave `command`, with the controller's `status` after it.
    pub fn new(command: ArmCommand<C>, status: &Status, instructions: u32) -> Self {
        Self {
            command,
            tick: status.tick,
            state: status.state,
            fault: status.fault,
            angle: status.angle,
            velocity: status.velocity,
            tool: status.tool,
            current_demand: status.current_demand,
            instructions,
        }
    }
}
