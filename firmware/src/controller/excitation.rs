//! Excitation: a voltage or a current on one motor of an arm that is not homed, without feedback of
//! its position, to measure motor and wiring before anything is known of them.
//!
//! The other motor's terminals are shorted by its bridge, which slows its joint down. Three limits
//! are checked in each tick: the measured current, the time, and the travel of either joint. At the
//! first one that is reached the excitation ends: both motors are shorted until the joints rest,
//! because that brakes whatever the signs of wiring and sensors are. Then the holding brakes engage, and
//! the bridges go off.
//! Faults are detected as ever, and a silent host is one.

use super::tick::{Measurement, UnpoweredOutput};
use super::{ArmController, RequestError};
use crate::drives::{Drives, Excitation, Excited};
use crate::io::{ArmCommand, ArmSample};
use crate::safety::{Event, Fault};
use fivebar_kinematics::{Scalar, five_bar};
use serde::{Deserialize, Serialize};

/// Joint speed below which the shorted motors have brought an arm to rest [rad/s].
const REST_SPEED: f32 = 0.05;
/// The longest braking [s]: gravity may move an arm on shorted motors for ever.
const LONGEST_BRAKING: f32 = 0.5;
/// The shortest braking, in which the currents vanish [s].
const SHORTEST_BRAKING: f32 = 0.005;

/// What ended an excitation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ExcitationEnd {
    /// Its duration was over.
    Time,
    /// A joint reached the travel.
    Travel,
    /// A motor reached the current.
    Current,
}

/// The excitation in progress.
#[derive(Clone)]
pub(super) struct ExcitationState {
    excitation: Excitation,
    /// Angles at its beginning [rad].
    start: [f32; 2],
    /// Ticks since its beginning, or since the beginning of the braking.
    ticks: u32,
    /// State of the sequence's shift register, never 0.
    register: u16,
    /// What ended it; none while it lasts, and before the first one.
    end: Option<ExcitationEnd>,
    /// Braking lasts between so many ticks.
    braking: [u32; 2],
}

impl ExcitationState {
    /// No excitation.
    pub(super) fn none(tick_rate: f32) -> Self {
        Self {
            excitation: Excitation {
                joint: 0,
                of: Excited::Voltage,
                offset: 0.0,
                amplitude: 0.0,
                hold: 1,
                ticks: 0,
                current: 0.0,
                travel: 0.0,
            },
            start: [0.0; 2],
            ticks: 0,
            register: 1,
            end: None,
            braking: [SHORTEST_BRAKING, LONGEST_BRAKING].map(|time| (time * tick_rate) as u32),
        }
    }

    fn begin(&mut self, excitation: &Excitation) {
        self.excitation = *excitation;
        self.ticks = 0;
        self.register = 1;
        self.end = None;
    }

    /// The limit that this tick has reached.
    fn reached(&self, angle: [f32; 2], current: [f32; 2]) -> Option<ExcitationEnd> {
        let Excitation { travel, ticks, .. } = self.excitation;
        let ([angle1, angle4], [start1, start4]) = (angle, self.start);
        let [current1, current4] = current;
        let most = self.excitation.current;
        if Scalar::abs(current1) > most || Scalar::abs(current4) > most {
            return Some(ExcitationEnd::Current);
        }
        if Scalar::abs(angle1 - start1) > travel || Scalar::abs(angle4 - start4) > travel {
            return Some(ExcitationEnd::Travel);
        }
        (self.ticks >= ticks).then_some(ExcitationEnd::Time)
    }

    /// The next value [V or A]. The sequence is that of a 16-bit shift register of maximum length.
    fn value(&mut self) -> f32 {
        let Excitation {
            offset,
            amplitude,
            hold,
            ..
        } = self.excitation;
        if self.ticks.checked_rem(u32::from(hold)) == Some(0) {
            let out = self.register & 1;
            self.register = (self.register >> 1) ^ (0xb400 * out);
        }
        if self.register & 1 == 1 {
            offset + amplitude
        } else {
            offset - amplitude
        }
    }
}

impl<D: Drives> ArmController<D> {
    /// Sets an excitation up, if the arm may have one.
    pub(super) fn prepare_excitation(
        &mut self,
        excitation: &Excitation,
    ) -> Result<(), RequestError> {
        if self.homed {
            return Err(RequestError::Homed);
        }
        if !D::admits(&self.settings, excitation) {
            return Err(RequestError::Excitation);
        }
        self.excitation.begin(excitation);
        Ok(())
    }

    /// What ended the last excitation; none while it lasts, and before the first one.
    pub fn excitation_end(&self) -> Option<ExcitationEnd> {
        self.excitation.end
    }

    /// One tick of an excitation.
    pub(super) fn excite(
        &mut self,
        sample: &ArmSample<D::Sample>,
        measurement: &Measurement,
    ) -> UnpoweredOutput {
        let silent = self.host_timed_out().then_some(Fault::CommandTimeout);
        let fault = self.fault_in_sample(sample, measurement).or(silent);
        if let Some(fault) = fault.or_else(|| self.excited_motor_fault()) {
            self.power_off(fault);
            return UnpoweredOutput::Off;
        }
        if self.brake.still_releases(self.ticks) {
            return UnpoweredOutput::Excited;
        }
        let (angles, current) = (self.angles(), self.drives.report().current);
        let excitation = &mut self.excitation;
        if excitation.ticks == 0 && excitation.end.is_none() {
            excitation.start = angles;
        }
        if excitation.end.is_none()
            && let Some(end) = excitation.reached(angles, current)
        {
            excitation.end = Some(end);
            excitation.ticks = 0;
        }
        if excitation.end.is_some() {
            return self.brake_excited(measurement);
        }
        let value = excitation.value();
        excitation.ticks += 1;
        self.drive_excited(value)
    }

    /// The fault that a motor's equation shows while the current loop drives. A voltage is not checked: it
    /// cannot drive more than twice the continuous current, and whoever excites the motor finds by it
    /// what is wrong with sensors and wiring.
    fn excited_motor_fault(&mut self) -> Option<Fault> {
        let excitation = &self.excitation;
        match (excitation.excitation.of, excitation.end) {
            (Excited::Current, None) => self.contradiction(),
            (Excited::Current, Some(_)) | (Excited::Voltage, _) => None,
        }
    }

    /// The voltage or the current on one motor; the other one is shorted.
    fn drive_excited(&mut self, value: f32) -> UnpoweredOutput {
        let Excitation { joint, of, .. } = self.excitation.excitation;
        let index = usize::from(joint);
        let (Some(driven), Some(joint)) = (five_bar::Joint::ALL.get(index), self.joints.get(index))
        else {
            return UnpoweredOutput::Off;
        };
        self.drives.excite(*driven, of, value, joint.velocity());
        if self.drives.is_finite() {
            return UnpoweredOutput::Excited;
        }
        self.power_off(Fault::NotANumber);
        UnpoweredOutput::Off
    }

    /// Both motors shorted, until the joints rest.
    fn brake_excited(&mut self, measurement: &Measurement) -> UnpoweredOutput {
        self.release_loops();
        let excitation = &mut self.excitation;
        excitation.ticks += 1;
        let [least, most] = excitation.braking;
        let [omega1, omega4] = measurement.velocity;
        let rests = Scalar::abs(omega1) < REST_SPEED && Scalar::abs(omega4) < REST_SPEED;
        if excitation.ticks < most && !(rests && excitation.ticks >= least) {
            return UnpoweredOutput::Excited;
        }
        if !self.brake.engages(self.ticks) {
            return UnpoweredOutput::Excited;
        }
        // Exciting accepts this event.
        let _ = self.dispatch(Event::Finish);
        self.unpowered();
        UnpoweredOutput::Off
    }

    /// Both bridges on with the joints' duties.
    #[inline(always)]
    pub(super) fn excited(&self) -> ArmCommand<D::Command> {
        ArmCommand {
            drives: self.drives.command(),
            enable: [true; 2],
            brake: self.brake.is_on(),
            ..self.off()
        }
    }
}

#[cfg(test)]
mod tests;
