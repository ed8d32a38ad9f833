//! The faults that a tick detects, by the trip points of the [`Monitor`].
//!
//! [`Monitor`]: crate::safety::Monitor

use super::Controller;
use super::tick::Measurement;
use crate::io::SensorSample;
use crate::safety::{Fault, State, TOLERATED_TICKS};

impl Controller {
    /// The most serious fault that the sample alone shows. While the bridges are off, only the
    /// emergency stop and an encoder jump are faults.
    #[inline(always)]
    pub(super) fn sampled_fault(
        &self,
        sample: &SensorSample,
        measurement: &Measurement,
    ) -> Option<Fault> {
        let monitor = &self.model.monitor;
        if sample.emergency_stop {
            return Some(Fault::EmergencyStop);
        }
        if monitor.jumped(measurement.innovation) {
            return Some(Fault::EncoderJump);
        }
        if !self.is_powered() {
            return None;
        }
        // A bridge's fault output means nothing while the bridge wakes up.
        let [driver1, driver4] = sample.driver_fault;
        if (driver1 | driver4) && self.waking == 0 {
            return Some(Fault::DriverFault);
        }
        if monitor.over_current(measurement.current) {
            return Some(Fault::OverCurrent);
        }
        if monitor.over_speed(measurement.velocity) {
            return Some(Fault::OverSpeed);
        }
        if let Some(fault) = monitor.bus(self.bus_voltage) {
            return Some(fault);
        }
        measurement.too_hot.then_some(Fault::OverTemperature)
    }

    /// Counts missed ticks. More than [`TOLERATED_TICKS`] at once are a fault while the bridges
    /// are on, because the observer and the loops then have lost the arm's motion.
    #[cold]
    pub(super) fn overrun(&mut self, missed: u32) {
        self.missed_ticks = self.missed_ticks.saturating_add(missed);
        if missed > TOLERATED_TICKS && self.is_powered() {
            self.latch_fault(Fault::TickOverrun);
        }
    }

    /// The fault, if any, that stops the arm on its path. It is checked at the end of the tick,
    /// and the stop begins with the next tick: the tick that latches a fault takes long enough.
    #[inline(always)]
    pub(super) fn stopping_fault(&self) -> Option<Fault> {
        match self.state {
            State::Running if self.path.runs_short() => Some(Fault::QueueUnderrun),
            State::Running | State::Stopping if self.host_timed_out() => {
                Some(Fault::CommandTimeout)
            }
            State::Running | State::Stopping | State::Stopped => None,
            State::Homing | State::Armed | State::Fault => None,
        }
    }

    /// Whether the host has sent nothing for longer than the command timeout.
    #[inline(always)]
    pub(super) fn host_timed_out(&self) -> bool {
        let silence = self.ticks.wrapping_sub(self.heard_at);
        self.model.monitor.silent(silence)
    }

    /// Restarts the command timeout: the host has given a sign of life.
    pub fn feed_host_timeout(&mut self) {
        self.heard_at = self.ticks;
    }
}
