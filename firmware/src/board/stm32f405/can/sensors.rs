//! The sources of a sensor sample with drives on a bus: their answers, and the switches.

use super::pins::Switches;
use crate::ArmSample;
use crate::drives::TorqueSample;

/// The switches.
pub struct Sensors {
    /// Home switches and emergency stop.
    pub switches: Switches,
}

impl Sensors {
    /// One sensor sample, with what the drives have answered. `missed_ticks` is the number of ticks missed since the last one;
    /// `stopped` is an emergency stop of the host.
    #[inline]
    pub fn sample(
        &mut self,
        (counts, drives): ([i32; 2], TorqueSample),
        missed_ticks: u32,
        stopped: bool,
    ) -> ArmSample<TorqueSample> {
        ArmSample {
            counts,
            drives,
            home: self.switches.home(),
            index: self.switches.index(),
            emergency_stop: self.switches.emergency_stop() || stopped,
            driver_fault: self.switches.driver_fault(),
            missed_ticks,
        }
    }
}
