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
    #[expect(clippy::too_many_lines, reason = "a list of faults")]
    pub fn inject(&mut self, fault: FaultKind) {
        use FaultKind::*;
        match fault {
            EncoderDead { joint } => self.faults.frozen_counts[joint] = Some(self.counts(joint)),
            EncoderJump { joint, counts } => {
                self.count_origin[joint] = self.count_origin[joint].wrapping_add(counts);
            }
            EncoderGain { joint, gain } => {
                self.set_encoder(joint, EncoderDefect::Gain(self.counts(joint), gain));
            }
            EncoderLate { joint, ticks } => {
                let late = Late::new(self.counts(joint), ticks);
                self.set_encoder(joint, EncoderDefect::Late(late));
            }
            EncoderChannelStuck { joint } => {
                self.set_encoder(joint, EncoderDefect::ChannelStuck(self.counts(joint)));
            }
            EncoderNoise { joint, counts } => self.set_encoder(joint, EncoderDefect::Noise(counts)),
            IndexStuck { joint, high } => self.faults.sensors.indices[joint] = Some(high),
            SwitchStuck { joint, pressed } => self.faults.stuck_switch[joint] = Some(pressed),
            MotorDisconnected { joint } => self.faults.disconnected[joint] = true,
            WindingShorted { joint } => self.model.motors[joint].short_half(),
            MotorStalled { joint } => {
                self.faults.stalled[joint] = true;
                self.hold(joint, true);
            }
            CurrentOffset { joint, amperes } => {
                let sensor = &mut self.sensors[joint];
                sensor.current_offset += amperes / sensor.current_per_code;
            }
            CurrentDead { joint } => {
                self.set_current(joint, CurrentDefect::Stuck(self.current_code(joint, 0.0)));
            }
            CurrentGain { joint, gain } => {
                let zero = self.sensors[joint].current_zero_code;
                self.set_current(joint, CurrentDefect::Gain(zero, gain));
            }
            CurrentStuck { joint, amperes } => {
                let code = self.current_code(joint, amperes);
                self.set_current(joint, CurrentDefect::Stuck(code));
            }
            CurrentLate { joint, ticks } => {
                let present = self.current_code(joint, self.state.current[joint]);
                let late = Late::new(present, ticks);
                self.set_current(joint, CurrentDefect::Late(late));
            }
            BusVoltage { volts } => self.bus_voltage = volts,
            BusSensorStuck => {
                let code = adc_code(self.bus_voltage() / self.volts_per_code);
                self.faults.sensors.bus = Some(BusDefect::Stuck(code));
            }
            BusSensorGain { gain } => self.faults.sensors.bus = Some(BusDefect::Gain(gain)),
            BridgeOneDirection { joint } => self.set_bridge(joint, BridgeDefect::OneDirection),
            BridgeShorted { joint } => self.set_bridge(joint, BridgeDefect::Shorted),
            DutyStuck { joint } => {
                let duty = self.active.drives.duty[joint].into();
                self.set_bridge(joint, BridgeDefect::Stuck(duty));
            }
            DriverFaultStuck { joint } | DriverFaultOpen { joint } => {
                self.faults.sensors.driver_fault[joint] = true;
            }
            DriverFault { joint } => self.faults.driver_fault[joint] = true,
            EmergencyStop => self.faults.emergency_stop = true,
            EmergencyStopWelded => self.faults.stop_welded = true,
            ContactorWelded => self.contactor.welded = true,
            BrakeStuck { joint } => self.faults.brake_stuck[joint] = true,
            BrakeLate { joint, seconds } => self.brakes[joint].engage_time += seconds,
            BrakeFails { joint } => self.brakes[joint].fail(),
            CouplingSlips { joint, share } => {
                let from = self.shaft(joint).0;
                self.faults.slipping[joint] = Some(Slip { from, share });
            }
            StepLost { joint, steps } => self.faults.missed_steps[joint] += steps,
            PhaseOpen { joint } => self.faults.phase_open[joint] = true,
            CanSilent { joint } => self.faults.cut_off[joint] = true,
            CanReset { joint } => self.faults.resets[joint] = true,
            CanBusOff => self.faults.bus_off = true,
            BeltBreaks { joint } => self.drives.iter_mut().for_each(|all| all.break_belt(joint)),
            PayloadChanges { kilograms } => self.model.change_payload(&mut self.state, kilograms),
            ToolCaught => self.faults.caught = Some(self.tool()),
            TicksMissed { ticks } => self.late_by = ticks,
        }
    }

    fn set_encoder(&mut self, joint: Joint, defect: EncoderDefect) {
        self.faults.sensors.encoders[joint] = Some(defect);
    }

    fn set_current(&mut self, joint: Joint, defect: CurrentDefect) {
        self.faults.sensors.currents[joint] = Some(defect);
    }

    fn set_bridge(&mut self, joint: Joint, defect: BridgeDefect) {
        self.faults.bridges[joint] = Some(defect);
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
