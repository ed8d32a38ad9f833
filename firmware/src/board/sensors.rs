//! Everything a tick's samples come from.

use super::analog::CurrentsAndBus;
use super::encoders::Encoders;
use super::pins::Switches;
use crate::Sensed;

/// Encoders, converter and switches.
pub struct Sensors {
    /// Both encoders.
    pub encoders: Encoders,
    /// Currents and bus voltage.
    pub analog: CurrentsAndBus,
    /// Switches and fault outputs.
    pub switches: Switches,
}

impl Sensors {
    /// One tick's samples. `missed_ticks` came since the last ones and were not made;
    /// `stopped` is an emergency stop that the button no longer shows.
    #[inline]
    pub fn sample(&mut self, missed_ticks: u32, stopped: bool) -> Sensed {
        let counts = self.encoders.latch();
        let samples = self.analog.take();
        Sensed {
            counts,
            current: samples.current,
            bus_voltage: samples.bus_voltage,
            home: self.switches.home(),
            emergency_stop: self.switches.emergency_stop() || stopped,
            driver_fault: self.switches.driver_fault(),
            missed_ticks,
        }
    }
}
