//! The injected faults of the plant.

/// The faults that are active.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ActiveFaults {
    pub(crate) frozen_counts: [Option<i32>; 2],
    pub(crate) stuck_switch: [Option<bool>; 2],
    pub(crate) disconnected: [bool; 2],
    pub(crate) stalled: [bool; 2],
    pub(crate) driver_fault: [bool; 2],
    pub(crate) emergency_stop: bool,
}
