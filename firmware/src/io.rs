//! What the tick reads and writes: sensor samples and actuator commands, without HAL types. What only one kind of
//! drive senses or does is its own: [`Drives::Sample`](crate::drives::Drives::Sample) and
//! [`Drives::Command`](crate::drives::Drives::Command).

use crate::drives::words::SensedWords;
use crate::drives::{BrushedCommand, BrushedSample};
use crate::settings::Share;
use serde::{Deserialize, Serialize};

/// The sample of an arm with brushed motors on H-bridges.
pub type SensorSample = ArmSample<BrushedSample>;

/// The sample of an arm with drives of any kind, as a host reads it.
pub type ToldSample = ArmSample<SensedWords>;

/// The command of an arm with brushed motors on H-bridges.
pub type ActuatorCommand = ArmCommand<BrushedCommand>;

/// One tick's samples, as the peripherals deliver them. Index 0 is joint 1 (at A),
/// index 1 is joint 4 (at E).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArmSample<S> {
    /// Encoder counts, both latched together; they wrap.
    pub counts: [i32; 2],
    /// What the drives sense.
    pub drives: S,
    /// Home switches, true when pressed.
    pub home: [bool; 2],
    /// Index pulses of the encoders, true where an encoder shows its index.
    pub index: [bool; 2],
    /// Emergency stop, true when pressed.
    pub emergency_stop: bool,
    /// Fault outputs of the drives, true when raised.
    pub driver_fault: [bool; 2],
    /// Ticks missed since the last one.
    pub missed_ticks: u32,
}

/// What the drives, the brake and the tool do until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArmCommand<C> {
    /// What the drives do.
    pub drives: C,
    /// Whether each drive is powered. Off, its motor gives no torque.
    pub enable: [bool; 2],
    /// Engage the holding brake, where one is fitted.
    pub brake: bool,
    /// The share of time for which the tool's pin is high, see
    /// [`ToolOutputSettings`](crate::settings::ToolOutputSettings).
    pub tool: Share,
}

impl<S> ArmSample<S> {
    /// The same sample with this of the drives.
    #[inline(always)]
    pub fn with_drives<T>(&self, drives: T) -> ArmSample<T> {
        ArmSample {
            counts: self.counts,
            drives,
            home: self.home,
            index: self.index,
            emergency_stop: self.emergency_stop,
            driver_fault: self.driver_fault,
            missed_ticks: self.missed_ticks,
        }
    }
}

impl<C> ArmCommand<C> {
    /// The same command with this for the drives.
    #[inline(always)]
    pub fn with_drives<T>(&self, drives: T) -> ArmCommand<T> {
        ArmCommand {
            drives,
            enable: self.enable,
            brake: self.brake,
            tool: self.tool,
        }
    }
}
