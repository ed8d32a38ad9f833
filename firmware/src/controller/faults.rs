//! The faults that a tick detects, by the trip points of the [`Monitor`].
//!
//! [`Monitor`]: crate::safety::Monitor

use super::ArmController;
use super::tick::Measurement;
use crate::drives::Drives;
use crate::io::ArmSample;
use crate::safety::{Fault, State};

impl<D: Drives> ArmController<D> {
    /// The most serious fault that the sample alone shows, with the bridges on. Each of them
    /// switches the bridges off.
    #[inline(always)]
    pub(super) fn fault_in_sample(
        &self,
        sample: &ArmSample<D::Sample>,
        measurement: &Measurement,
    ) -> Option<Fault> {
        if let Some(fault) = self.unpowered_fault(sample, measurement.innovation) {
            return Some(fault);
        }
        if self.pending_off.is_some() {
            return self.pending_off;
        }
        let [driver1, driver4] = sample.driver_fault;
        if driver1 | driver4 {
            return Some(Fault::DriverFault);
        }
        self.measured_fault(measurement)
    }

    /// The faults that the measured values show with the bridges on, also while these wake up and
    /// their fault outputs mean nothing.
    #[inline(always)]
    pub(super) fn measured_fault(&self, measurement: &Measurement) -> Option<Fault> {
        let monitor = &self.model.monitor;
        if let Some(fault) = self.drives.drive_fault() {
            return Some(fault);
        }
        if monitor.over_speed(measurement.velocity) {
            return Some(Fault::OverSpeed);
        }
        self.drives.supply_fault()
    }

    /// The fault that drives and joints show together, in a tick in which the loops drive.
    #[inline(always)]
    pub(super) fn contradiction(&mut self) -> Option<Fault> {
        let [joint1, joint4] = &self.joints;
        let [error1, error4] = self.error;
        self.drives
            .contradiction([joint1.state(error1), joint4.state(error4)])
    }

    /// The faults that do not need the bridges to be on.
    #[inline(always)]
    pub(super) fn unpowered_fault(
        &self,
        sample: &ArmSample<D::Sample>,
        innovation: [f32; 2],
    ) -> Option<Fault> {
        if sample.emergency_stop {
            return Some(Fault::EmergencyStop);
        }
        let jumped = self.model.monitor.jumped(innovation);
        jumped.then_some(Fault::EncoderJump)
    }

    /// The fault, if any, that stops the arm on its path.
    #[inline(always)]
    pub(super) fn stopping_fault(&self) -> Option<Fault> {
        match self.state {
            State::Running if self.path.runs_short() => Some(Fault::QueueUnderrun),
            State::Running | State::Stopping | State::Compliant if self.host_timed_out() => {
                Some(Fault::CommandTimeout)
            }
            State::Running | State::Stopping | State::Compliant | State::Stopped => None,
            State::Homing | State::Exciting | State::Crossing | State::Armed | State::Fault => None,
        }
    }

    /// Whether the host has sent nothing for longer than the command timeout.
    #[inline(always)]
    pub(super) fn host_timed_out(&self) -> bool {
        self.model.monitor.silent(self.silence())
    }

    /// Whether the host has sent nothing for so long that the arm is left alone.
    #[inline(always)]
    pub(super) fn abandoned(&self) -> bool {
        self.model.monitor.abandoned(self.silence())
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
