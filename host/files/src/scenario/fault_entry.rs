//! `[[fault]]` of a scenario file: a fault to inject, and its time.

use crate::source::{FileError, Key, Source};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Parameters};
use serde::Deserialize;

/// One fault as written. Its kind decides which keys it needs.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FaultEntry {
    /// Time from the beginning of the job [s]; none: from power-up.
    at: Option<f64>,
    kind: Kind,
    /// 1 or 4.
    joint: Option<u8>,
    counts: Option<i32>,
    pressed: Option<bool>,
    amperes: Option<f64>,
    volts: Option<f64>,
    ticks: Option<u32>,
    gain: Option<f64>,
    high: Option<bool>,
    kilograms: Option<f64>,
    seconds: Option<f64>,
    share: Option<f64>,
    steps: Option<u32>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    EncoderDead,
    EncoderJump,
    EncoderGain,
    EncoderLate,
    EncoderChannelStuck,
    EncoderNoise,
    IndexStuck,
    SwitchStuck,
    MotorDisconnected,
    WindingShorted,
    MotorStalled,
    CurrentOffset,
    CurrentDead,
    CurrentGain,
    CurrentStuck,
    CurrentLate,
    BusVoltage,
    BusSensorStuck,
    BusSensorGain,
    BridgeOneDirection,
    BridgeShorted,
    DutyStuck,
    DriverFault,
    DriverFaultStuck,
    DriverFaultOpen,
    EmergencyStop,
    EmergencyStopWelded,
    ContactorWelded,
    BrakeStuck,
    BrakeLate,
    BrakeFails,
    CouplingSlips,
    BeltBreaks,
    StepLost,
    PayloadChanges,
    ToolCaught,
    TicksMissed,
}

impl FaultEntry {
    pub(super) fn fault(
        &self,
        source: &Source<'_>,
        index: usize,
    ) -> Result<(Option<f64>, FaultKind), FileError> {
        let key = |name| Key::Of("fault", index, name);
        if let Some(at) = self.at
            && !(at >= 0.0 && at.is_finite())
        {
            let reason =
                format!("must be a time in seconds after the beginning of the job, not {at:?}");
            return Err(source.refuse(key("at"), reason));
        }
        let missing = |name, what: &str| source.refuse(key(name), format!("is missing: {what}"));
        let joint = || {
            let number = self.joint.ok_or_else(|| missing("joint", "1 or 4"))?;
            let other = || source.refuse(key("joint"), format!("is 1 or 4, not {number}"));
            Joint::numbered(number).ok_or_else(other)
        };
        let finite = |name, value: Option<f64>, what: &str| match value {
            Some(value) if value.is_finite() => Ok(value),
            Some(value) => Err(source.refuse(key(name), format!("must be finite, not {value:?}"))),
            None => Err(missing(name, what)),
        };
        let within = |name, value: Option<f64>, [least, most]: [f64; 2], what: &str| match value {
            Some(value) if least <= value && value <= most => Ok(value),
            Some(value) => {
                let reason = format!("is {least:?} to {most:?}, not {value:?}");
                Err(source.refuse(key(name), reason))
            }
            None => Err(missing(name, what)),
        };
        let gain = || finite("gain", self.gain, "the factor");
        let level = |name, value: Option<bool>| value.ok_or_else(|| missing(name, "true or false"));
        let ticks = || match self.ticks {
            Some(ticks @ 1..=10_000) => Ok(ticks),
            Some(other) => {
                let reason = format!("is 1 to 10000, not {other}");
                Err(source.refuse(key("ticks"), reason))
            }
            None => Err(missing("ticks", "a number from 1 to 10000")),
        };
        let counts = |what: &str| self.counts.ok_or_else(|| missing("counts", what));
        let kind = match self.kind {
            Kind::EncoderDead => FaultKind::EncoderDead { joint: joint()? },
            Kind::EncoderJump => FaultKind::EncoderJump {
                joint: joint()?,
                counts: counts("the change of the counts")?,
            },
            Kind::EncoderGain => FaultKind::EncoderGain {
                joint: joint()?,
                gain: gain()?,
            },
            Kind::EncoderLate => FaultKind::EncoderLate {
                joint: joint()?,
                ticks: ticks()?,
            },
            Kind::EncoderChannelStuck => FaultKind::EncoderChannelStuck { joint: joint()? },
            Kind::EncoderNoise => FaultKind::EncoderNoise {
                joint: joint()?,
                counts: match counts("the greatest error")? {
                    counts @ 0.. => counts,
                    other => {
                        let reason = format!("must not be less than 0, as {other} is");
                        return Err(source.refuse(key("counts"), reason));
                    }
                },
            },
            Kind::IndexStuck => FaultKind::IndexStuck {
                joint: joint()?,
                high: level("high", self.high)?,
            },
            Kind::SwitchStuck => FaultKind::SwitchStuck {
                joint: joint()?,
                pressed: level("pressed", self.pressed)?,
            },
            Kind::MotorDisconnected => FaultKind::MotorDisconnected { joint: joint()? },
            Kind::WindingShorted => FaultKind::WindingShorted { joint: joint()? },
            Kind::MotorStalled => FaultKind::MotorStalled { joint: joint()? },
            Kind::CurrentOffset => FaultKind::CurrentOffset {
                joint: joint()?,
                amperes: finite(
                    "amperes",
                    self.amperes,
                    "the shift of the sensor's zero [A]",
                )?,
            },
            Kind::CurrentDead => FaultKind::CurrentDead { joint: joint()? },
            Kind::CurrentGain => FaultKind::CurrentGain {
                joint: joint()?,
                gain: gain()?,
            },
            Kind::CurrentStuck => FaultKind::CurrentStuck {
                joint: joint()?,
                amperes: finite("amperes", self.amperes, "the current that it shows [A]")?,
            },
            Kind::CurrentLate => FaultKind::CurrentLate {
                joint: joint()?,
                ticks: ticks()?,
            },
            Kind::BusVoltage => FaultKind::BusVoltage {
                volts: finite("volts", self.volts, "the new bus voltage [V]")?,
            },
            Kind::BusSensorStuck => FaultKind::BusSensorStuck,
            Kind::BusSensorGain => FaultKind::BusSensorGain { gain: gain()? },
            Kind::BridgeOneDirection => FaultKind::BridgeOneDirection { joint: joint()? },
            Kind::BridgeShorted => FaultKind::BridgeShorted { joint: joint()? },
            Kind::DutyStuck => FaultKind::DutyStuck { joint: joint()? },
            Kind::DriverFault => FaultKind::DriverFault { joint: joint()? },
            Kind::DriverFaultStuck => FaultKind::DriverFaultStuck { joint: joint()? },
            Kind::DriverFaultOpen => FaultKind::DriverFaultOpen { joint: joint()? },
            Kind::EmergencyStop => FaultKind::EmergencyStop,
            Kind::EmergencyStopWelded => FaultKind::EmergencyStopWelded,
            Kind::ContactorWelded => FaultKind::ContactorWelded,
            Kind::BrakeStuck => FaultKind::BrakeStuck { joint: joint()? },
            Kind::BrakeLate => FaultKind::BrakeLate {
                joint: joint()?,
                seconds: within(
                    "seconds",
                    self.seconds,
                    [0.0, 10.0],
                    "the additional time [s]",
                )?,
            },
            Kind::BrakeFails => FaultKind::BrakeFails { joint: joint()? },
            Kind::CouplingSlips => FaultKind::CouplingSlips {
                joint: joint()?,
                share: within("share", self.share, [0.0, 0.99], "the share that is lost")?,
            },
            Kind::BeltBreaks => FaultKind::BeltBreaks { joint: joint()? },
            Kind::StepLost => FaultKind::StepLost {
                joint: joint()?,
                steps: match self.steps {
                    Some(steps @ 1..=10_000) => steps,
                    Some(other) => {
                        let reason = format!("is 1 to 10000 full steps, not {other}");
                        return Err(source.refuse(key("steps"), reason));
                    }
                    None => return Err(missing("steps", "the number of full steps")),
                },
            },
            Kind::PayloadChanges => FaultKind::PayloadChanges {
                kilograms: finite(
                    "kilograms",
                    self.kilograms,
                    "the change of the payload [kg]",
                )?,
            },
            Kind::ToolCaught => FaultKind::ToolCaught,
            Kind::TicksMissed => FaultKind::TicksMissed { ticks: ticks()? },
        };
        Ok((self.at, kind))
    }

    /// Refuses a fault of a part that the arm does not have.
    pub(super) fn check_for(
        &self,
        parameters: &Parameters,
        has_steppers: bool,
        source: &Source<'_>,
        index: usize,
    ) -> Result<(), FileError> {
        let refused =
            |name, reason: &str| Err(source.refuse(Key::Of("fault", index, name), reason));
        let kind = self.fault(source, index)?.1;
        match kind {
            FaultKind::StepLost { .. } if !has_steppers => {
                refused("kind", "needs an arm with steppers")
            }
            _ if has_steppers && !kind.is_of_steppers() => refused(
                "kind",
                "is of brushed motors and encoders, and this arm has steppers",
            ),
            FaultKind::BeltBreaks { joint }
                if parameters.transmissions[joint].stiffness.is_none() =>
            {
                refused("kind", "needs an arm whose drives have a `stiffness`")
            }
            FaultKind::BrakeStuck { joint }
            | FaultKind::BrakeLate { joint, .. }
            | FaultKind::BrakeFails { joint }
                if parameters.brake_torque[joint] <= 0.0 =>
            {
                refused("kind", "needs an arm with a `brake_torque`")
            }
            FaultKind::PayloadChanges { kilograms }
                if parameters.arm.payload() + kilograms < 0.0 =>
            {
                refused("kilograms", "takes more than the payload away")
            }
            _ => Ok(()),
        }
    }
}
