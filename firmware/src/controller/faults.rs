//! What a tick can find wrong, by the trip points of the [`Monitor`].
//!
//! [`Monitor`]: crate::safety::Monitor

use super::Controller;
use super::tick::Samples;
use crate::io::Sensed;
use crate::safety::{Fault, State, TOLERATED_TICKS};

impl Controller {
    /// The gravest fault that the samples alone show. Unpowered, only what makes the
    /// angles or the stop button untrue counts.
    #[inline(always)]
    pub(super) fn sampled_fault(&self, sensed: &Sensed, samples: &Samples) -> Option<Fault> {
        let monitor = &self.model.monitor;
        if sensed.emergency_stop {
            return Some(Fault::EmergencyStop);
        }
        if monitor.jumped(samples.innovation) {
            return Some(Fault::EncoderJump);
        }
        if !self.is_powered() {
            return None;
        }
        let [driver1, driver4] = sensed.driver_fault;
        if driver1 | driver4 {
            return Some(Fault::DriverFault);
        }
        if monitor.over_current(samples.current) {
            return Some(Fault::OverCurrent);
        }
        if monitor.over_speed(samples.velocity) {
            return Some(Fault::OverSpeed);
        }
        if let Some(fault) = monitor.bus(self.bus_voltage) {
            return Some(fault);
        }
        samples.too_hot.then_some(Fault::OverTemperature)
    }

    /// Ticks were missed. So many at once that the loops no longer know the arm are a
    /// fault while the bridges are on; all are counted.
    #[cold]
    pub(super) fn overrun(&mut self, missed: u32) {
        self.missed_ticks = self.missed_ticks.saturating_add(missed);
        if missed > TOLERATED_TICKS && self.is_powered() {
            self.latch_fault(Fault::TickOverrun);
        }
    }

    /// The fault, if any, that stops the arm on its path. It is looked for when the tick's
    /// work is done, and the braking begins with the next: the tick that latches a fault is
    /// long enough.
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

    /// Whether the host has been silent for too long.
    #[inline(always)]
    pub(super) fn host_timed_out(&self) -> bool {
        let silence = self.ticks.wrapping_sub(self.heard_at);
        self.model.monitor.silent(silence)
    }

    /// The host has been heard: its silence begins anew.
    pub fn feed_host_timeout(&mut self) {
        self.heard_at = self.ticks;
    }
}
