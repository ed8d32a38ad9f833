//! The status that the controller reports, and the snapshot of a fault.

use crate::safety::{Fault, Limits, State};
use serde::{Deserialize, Serialize};

/// The controller after one tick. All angles and positions are those of the time when the tick
/// was sampled: `reference` is where the tool should have been then. Index 0 of a pair is joint
/// 1, index 1 joint 4.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Ticks since the reset.
    pub tick: u32,
    /// Ticks missed since the reset.
    pub missed_ticks: u32,
    /// The controller's state.
    pub state: State,
    /// The latched fault.
    pub fault: Option<Fault>,
    /// The limits that clipped in this tick.
    pub limits: Limits,
    /// Whether the joint angles are absolute.
    pub homed: bool,
    /// θ̂1, θ̂4 [rad]; from an unknown origin until homed.
    pub angle: [f32; 2],
    /// ω̂1, ω̂4 [rad/s].
    pub velocity: [f32; 2],
    /// The tool [m]; none until homed, or if no pose has the angles.
    pub tool: Option<[f32; 2]>,
    /// Where the tool should be [m]; none while the bridges are off.
    pub reference: Option<[f32; 2]>,
    /// The same for the joints.
    pub joint_reference: Option<JointReference>,
    /// The demanded torques τ1, τ4 [N·m].
    pub torque: [f32; 2],
    /// Current set-points [A].
    pub current_demand: [f32; 2],
    /// Measured currents [A].
    pub current: [f32; 2],
    /// Duties in −1…1.
    pub duty: [f32; 2],
    /// Bus voltage [V].
    pub bus_voltage: f32,
    /// Tag of the move in progress.
    pub tag: Option<u32>,
    /// The tool's level as a share: 0 is up or off, 1 is down or full power.
    pub tool_level: f32,
}

/// Where both driven joints should be, with velocity and acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointReference {
    /// θ1, θ4 [rad], in (−π, π].
    pub angle: [f32; 2],
    /// ω1, ω4 [rad/s].
    pub velocity: [f32; 2],
    /// α1, α4 [rad/s²].
    pub acceleration: [f32; 2],
}

/// The tick that raised a fault.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// The fault.
    pub fault: Fault,
    /// Ticks since the reset.
    pub tick: u32,
    /// The state in which it was raised.
    pub state: State,
    /// θ̂1, θ̂4 [rad].
    pub angle: [f32; 2],
    /// ω̂1, ω̂4 [rad/s].
    pub velocity: [f32; 2],
    /// Position errors [rad] as last computed.
    pub error: [f32; 2],
    /// Measured currents [A].
    pub current: [f32; 2],
    /// The demanded torques [N·m] as last computed.
    pub torque: [f32; 2],
    /// Bus voltage [V].
    pub bus_voltage: f32,
}
