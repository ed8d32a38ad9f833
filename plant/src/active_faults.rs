//! The injected faults of the plant.

use crate::sensor_defects::SensorDefects;
use nalgebra::Vector2;

/// The faults that are active.
#[derive(Clone, Debug, Default)]
pub(crate) struct ActiveFaults {
    pub(crate) frozen_counts: [Option<i32>; 2],
    pub(crate) stuck_switch: [Option<bool>; 2],
    pub(crate) disconnected: [bool; 2],
    pub(crate) stalled: [bool; 2],
    pub(crate) driver_fault: [bool; 2],
    /// Full steps of which the driver is going to miss the pulses.
    pub(crate) missed_steps: [u32; 2],
    /// Whether one phase of each stepper is open.
    pub(crate) phase_open: [bool; 2],
    /// Drives on a bus that take no part on it, and those that are about to reset.
    pub(crate) cut_off: [bool; 2],
    pub(crate) resets: [bool; 2],
    /// The controller has left the bus.
    pub(crate) bus_off: bool,
    pub(crate) emergency_stop: bool,
    /// Whether the emergency stop's contact is welded.
    pub(crate) stop_welded: bool,
    pub(crate) brake_stuck: [bool; 2],
    pub(crate) slipping: [Option<Slip>; 2],
    pub(crate) bridges: [Option<BridgeDefect>; 2],
    pub(crate) sensors: SensorDefects,
    /// Where the tool is caught [m].
    pub(crate) caught: Option<Vector2<f64>>,
}

/// A coupling that slips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slip {
    /// The angle at which it began [rad].
    pub(crate) from: f64,
    /// The share of the motor's motion that does not reach the joint.
    pub(crate) share: f64,
}

impl Slip {
    /// The angle of the motor, over the gear ratio, of a joint at this angle [rad].
    pub(crate) fn motor(self, joint: f64) -> f64 {
        self.from + (joint - self.from) / (1.0 - self.share)
    }
}

/// A defect of a bridge that is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum BridgeDefect {
    /// It drives in the direction of positive duties only.
    OneDirection,
    /// One of its transistors is shorted.
    Shorted,
    /// It keeps this duty.
    Stuck(f64),
}

impl BridgeDefect {
    /// The duty that acts in place of this one.
    pub(crate) fn acting(self, duty: f64) -> f64 {
        match self {
            Self::OneDirection => duty.max(0.0),
            Self::Shorted => 1.0,
            Self::Stuck(stuck) => stuck,
        }
    }
}
