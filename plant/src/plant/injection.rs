//! What an injected fault changes in the arm.

use super::Plant;
use crate::active_faults::{BridgeDefect, Slip};
use crate::fault::{FaultKind, PlantFault};
use crate::sensor_defects::{BusDefect, CurrentDefect, EncoderDefect, Late};
use crate::sensors::adc_code;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::Vector2;

/// Stiffness [N/m] and damping [N·s/m] of what catches the tool.
const CATCHING: [f64; 2] = [5e4, 50.0];

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
            FaultKind::EncoderGain { joint, gain } => {
                let from = self.counts(joint);
                self.faults.sensors.encoders[joint] = Some(EncoderDefect::Gain(from, gain));
            }
            FaultKind::EncoderLate { joint, ticks } => {
                let late = Late::new(self.counts(joint), ticks);
                self.faults.sensors.encoders[joint] = Some(EncoderDefect::Late(late));
            }
            FaultKind::EncoderChannelStuck { joint } => {
                let from = self.counts(joint);
                self.faults.sensors.encoders[joint] = Some(EncoderDefect::ChannelStuck(from));
            }
            FaultKind::EncoderNoise { joint, counts } => {
                self.faults.sensors.encoders[joint] = Some(EncoderDefect::Noise(counts));
            }
            FaultKind::IndexStuck { joint, high } => {
                self.faults.sensors.indices[joint] = Some(high);
            }
            FaultKind::SwitchStuck { joint, pressed } => {
                self.faults.stuck_switch[joint] = Some(pressed);
            }
            FaultKind::MotorDisconnected { joint } => self.faults.disconnected[joint] = true,
            FaultKind::WindingShorted { joint } => self.model.motors[joint].short_half(),
            FaultKind::MotorStalled { joint } => {
                self.faults.stalled[joint] = true;
                self.hold(joint, true);
            }
            FaultKind::CurrentOffset { joint, amperes } => {
                let sensor = &mut self.sensors[joint];
                sensor.current_offset += amperes / sensor.current_per_code;
            }
            FaultKind::CurrentDead { joint } => {
                let code = self.current_code(joint, 0.0);
                self.faults.sensors.currents[joint] = Some(CurrentDefect::Stuck(code));
            }
            FaultKind::CurrentGain { joint, gain } => {
                let zero = self.sensors[joint].current_zero_code;
                self.faults.sensors.currents[joint] = Some(CurrentDefect::Gain(zero, gain));
            }
            FaultKind::CurrentStuck { joint, amperes } => {
                let code = self.current_code(joint, amperes);
                self.faults.sensors.currents[joint] = Some(CurrentDefect::Stuck(code));
            }
            FaultKind::CurrentLate { joint, ticks } => {
                let present = self.current_code(joint, self.state.current[joint]);
                let late = Late::new(present, ticks);
                self.faults.sensors.currents[joint] = Some(CurrentDefect::Late(late));
            }
            FaultKind::BusVoltage { volts } => self.bus_voltage = volts,
            FaultKind::BusSensorStuck => {
                let code = adc_code(self.bus_voltage() / self.volts_per_code);
                self.faults.sensors.bus = Some(BusDefect::Stuck(code));
            }
            FaultKind::BusSensorGain { gain } => {
                self.faults.sensors.bus = Some(BusDefect::Gain(gain));
            }
            FaultKind::BridgeOneDirection { joint } => {
                self.faults.bridges[joint] = Some(BridgeDefect::OneDirection);
            }
            FaultKind::BridgeShorted { joint } => {
                self.faults.bridges[joint] = Some(BridgeDefect::Shorted);
            }
            FaultKind::DutyStuck { joint } => {
                let duty = f64::from(self.active.drives.duty[joint]);
                self.faults.bridges[joint] = Some(BridgeDefect::Stuck(duty));
            }
            FaultKind::DriverFaultStuck { joint } | FaultKind::DriverFaultOpen { joint } => {
                self.faults.sensors.driver_fault[joint] = true;
            }
            FaultKind::DriverFault { joint } => self.faults.driver_fault[joint] = true,
            FaultKind::EmergencyStop => self.faults.emergency_stop = true,
            FaultKind::EmergencyStopWelded => self.faults.stop_welded = true,
            FaultKind::ContactorWelded => self.contactor.welded = true,
            FaultKind::BrakeStuck { joint } => self.faults.brake_stuck[joint] = true,
            FaultKind::BrakeLate { joint, seconds } => self.brakes[joint].engage_time += seconds,
            FaultKind::BrakeFails { joint } => self.brakes[joint].fail(),
            FaultKind::CouplingSlips { joint, share } => {
                self.faults.slipping[joint] = Some(Slip {
                    from: self.shaft(joint).0,
                    share,
                });
            }
            FaultKind::BeltBreaks { joint } => {
                if let Some(drives) = &mut self.drives {
                    drives.break_belt(joint);
                }
            }
            FaultKind::PayloadChanges { kilograms } => {
                self.model.change_payload(&mut self.state, kilograms);
            }
            FaultKind::ToolCaught => self.faults.caught = Some(self.tool()),
            FaultKind::TicksMissed { ticks } => self.late_by = ticks,
        }
    }

    /// The code of a current [A], without noise.
    fn current_code(&self, joint: Joint, amperes: f64) -> u16 {
        let sensor = &self.sensors[joint];
        adc_code(amperes / sensor.current_per_code + sensor.current_zero_code)
    }

    /// The force on the tool where it is caught [N].
    pub(super) fn catching_force(&self) -> Vector2<f64> {
        let [stiffness, damping] = CATCHING;
        self.faults.caught.map_or_else(Vector2::zeros, |caught| {
            let velocity = self.model.tool_velocity(&self.state);
            stiffness * (caught - self.tool()) - damping * velocity
        })
    }
}
