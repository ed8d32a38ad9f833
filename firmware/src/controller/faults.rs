//! The faults that a tick detects, by the trip points of the [`Monitor`].
//!
//! [`Monitor`]: crate::safety::Monitor

use super::Controller;
use super::tick::{ControlMode, Measurement};
use crate::io::SensorSample;
use crate::safety::{Fault, State};

impl Controller {
    /// The most serious fault that the sample alone shows, or that the host has left the arm
    /// alone. While the bridges are off, only the
    /// emergency stop and an encoder jump are faults. Each of them switches the bridges off.
    #[inline(always)]
    pub(super) fn sampled_fault(
        &self,
        sample: &SensorSample,
        measurement: &Measurement,
        mode: ControlMode,
    ) -> Option<Fault> {
        let monitor = &self.model.monitor;
        let fault = self.unpowered_fault(sample, measurement.innovation);
        if fault.is_some() || !mode.is_powered() {
            return fault;
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
        if measurement.too_hot {
            return Some(Fault::OverTemperature);
        }
        monitor
            .abandoned(self.silence())
            .then_some(Fault::CommandTimeout)
    }

    /// The faults that do not need the bridges to be on.
    #[inline(always)]
    pub(super) fn unpowered_fault(
        &self,
        sample: &SensorSample,
        innovation: [f32; 2],
    ) -> Option<Fault> {
        if sample.emergency_stop {
            return Some(Fault::EmergencyStop);
        }
        let jumped = self.model.monitor.jumped(innovation);
        jumped.then_some(Fault::EncoderJump)
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
        self.model.monitor.silent(self.silence())
    }

    /// Ticks since the host's last sign of life.
    #[inline(always)]
    fn silence(&self) -> u32 {
        self.ticks.wrapping_sub(self.heard_at)
    }

    /// Restarts the command timeout: the host has given a sign of life.
    pub fn feed_host_timeout(&mut self) {
        self.heard_at = self.ticks;
    }
}
