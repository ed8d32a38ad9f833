//! What the tick reads and writes: sensor samples and actuator commands, without HAL types.

use crate::settings::Share;
use serde::{Deserialize, Serialize};

/// One tick's samples, as the peripherals deliver them. Index 0 is joint 1 (at A),
/// index 1 is joint 4 (at E).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SensorSample {
    /// Encoder counts, both latched together; they wrap.
    pub counts: [i32; 2],
    /// Phase currents [ADC codes].
    pub current: [u16; 2],
    /// Bus voltage [ADC codes].
    pub bus_voltage: u16,
    /// Home switches, true when pressed.
    pub home: [bool; 2],
    /// Index pulses of the encoders, true where an encoder shows its index.
    pub index: [bool; 2],
    /// Emergency stop, true when pressed.
    pub emergency_stop: bool,
    /// Fault outputs of the bridges, true when raised.
    pub driver_fault: [bool; 2],
    /// Ticks missed since the last one.
    pub missed_ticks: u32,
}

/// What the bridges and the brake do until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ActuatorCommand {
    /// Duty of each bridge in −1…1: the mean voltage as a share of the bus voltage.
    pub duty: [f32; 2],
    /// Whether each bridge is powered. Off, its motor's terminals float.
    pub enable: [bool; 2],
    /// Engage the holding brake, where one is fitted.
    pub brake: bool,
    /// The share of time for which the tool's pin is high, see
    /// [`ToolOutputSettings`](crate::settings::ToolOutputSettings).
    pub tool: Share,
}
