//! What an injected fault changes in the arm.

use super::Plant;
use crate::fault::{FaultKind, PlantFault};

impl Plant {
    /// Injects each of these faults at its time from now.
    pub fn schedule_faults(&mut self, faults: &[PlantFault]) {
        self.pending.extend(faults.iter().map(|fault| PlantFault {
            at: self.time + fault.at,
            ..*fault
        }));
        self.pending.sort_by(|a, b| b.at.total_cmp(&a.at));
    }

    pub(super) fn inject_due_faults(&mut self) {
        while let Some(fault) = self.pending.pop_if(|fault| fault.at <= self.time) {
            self.inject(fault.kind);
        }
    }

    /// Injects a fault now.
    pub fn inject(&mut self, fault: FaultKind) {
        match fault {
            FaultKind::EncoderDead { joint } => {
                self.faults.frozen_counts[joint] = Some(self.counts(joint));
            }
            FaultKind::EncoderJump { joint, counts } => {
                self.count_origin[joint] = self.count_origin[joint].wrapping_add(counts);
            }
            FaultKind::SwitchStuck { joint, pressed } => {
                self.faults.stuck_switch[joint] = Some(pressed);
            }
            FaultKind::MotorDisconnected { joint } => self.faults.disconnected[joint] = true,
            FaultKind::MotorStalled { joint } => {
                self.faults.stalled[joint] = true;
                self.hold(joint, true);
            }
            FaultKind::CurrentOffset { joint, amperes } => {
                let sensor = &mut self.sensors[joint];
                sensor.current_offset += amperes / sensor.current_per_code;
            }
            FaultKind::BusVoltage { volts } => self.bus_voltage = volts,
            FaultKind::DriverFault { joint } => self.faults.driver_fault[joint] = true,
            FaultKind::EmergencyStop => self.faults.emergency_stop = true,
            FaultKind::TicksMissed { ticks } => self.late_by = ticks,
        }
    }
}
