//! The sources of a sensor sample.

use super::analog::CurrentsAndBus;
use super::encoders::Encoders;
use super::pins::Switches;
use crate::SensorSample;
use crate::drives::BrushedSample;

/// Encoders, converter and switches.
pub struct Sensors {
    /// Both encoders.
    pub encoders: Encoders,
    /// Currents and bus voltage.
    pub analog: CurrentsAndBus,
    /// Switches, index and fault outputs.
    pub switches: Switches,
}

impl Sensors {
    /// One sensor sample. `missed_ticks` is the number of ticks missed since the last one;
    /// `stopped` is an emergency stop that the button no longer shows.
    #[inline]
    pub fn sample(&mut self, missed_ticks: u32, stopped: bool) -> SensorSample {
        let counts = self.encoders.latched();
        let samples = self.analog.take();
        let drives = BrushedSample {
            current: samples.current,
            bus_voltage: samples.bus_voltage,
        };
        self.switches.sample(counts, drives, missed_ticks, stopped)
    }
}
