//! The injected faults of the plant.

/// The faults that are active.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ActiveFaults {
    pub(super) frozen_counts: [Option<i32>; 2],
    pub(super) stuck_switch: [Option<bool>; 2],
    pub(super) disconnected: [bool; 2],
    pub(super) stalled: [bool; 2],
    pub(super) driver_fault: [bool; 2],
    pub(super) emergency_stop: bool,
}
