//! A tick of the emulated board, by its bits.

use crate::safety::{Fault, State};
use crate::{Command, Status};
use serde::{Deserialize, Serialize};

/// What a tick made of its samples: what the bridges are told, and the state and estimates
/// behind it. Two controllers that agree in this bit by bit run as one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ticked {
    /// What the bridges are told.
    pub command: Command,
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
    /// Instructions the tick took, 0 where they are not counted.
    pub instructions: u32,
}

impl Ticked {
    /// The tick that gave `command` and left the controller at `status`.
    pub fn new(command: Command, status: &Status, instructions: u32) -> Self {
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
