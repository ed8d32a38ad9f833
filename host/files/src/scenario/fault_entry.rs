//! `[[fault]]` of a scenario file: a fault to inject, and its time.

use crate::refusal::Key;
use crate::robot::Robot;
use crate::source::{FileError, Source};
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
    PhaseOpen,
    CanSilent,
    CanReset,
    CanBusOff,
    PayloadChanges,
    ToolCaught,
    TicksMissed,
}

/// A fault's keys as they are read, each checked when its kind asks for it.
struct Keys<'a, 's> {
    entry: &'a FaultEntry,
    source: &'a Source<'s>,
    /// The number of the fault in the file.
    index: usize,
}

impl Keys<'_, '_> {
    fn refuse(&self, name: &'static str, reason: String) -> FileError {
        self.source
            .refuse(Key::Of("fault", self.index, name), reason)
    }

    fn given<T>(&self, name: &'static str, value: Option<T>, what: &str) -> Result<T, FileError> {
        value.ok_or_else(|| self.refuse(name, format!("is missing: {what}")))
    }

    /// Seconds after the beginning of the job; none: from power-up.
    fn at(&self) -> Result<Option<f64>, FileError> {
        match self.entry.at {
            Some(at) if !(at >= 0.0 && at.is_finite()) => {
                let reason =
                    format!("must be a time in seconds after the beginning of the job, not {at:?}");
                Err(self.refuse("at", reason))
            }
            at => Ok(at),
        }
    }

    fn joint(&self) -> Result<Joint, FileError> {
        let number = self.given("joint", self.entry.joint, "1 or 4")?;
        let other = || self.refuse("joint", format!("is 1 or 4, not {number}"));
        Joint::numbered(number).ok_or_else(other)
    }

    fn finite(&self, name: &'static str, value: Option<f64>, what: &str) -> Result<f64, FileError> {
        match self.given(name, value, what)? {
            value if value.is_finite() => Ok(value),
            value => Err(self.refuse(name, format!("must be finite, not {value:?}"))),
        }
    }

    fn within(
        &self,
        name: &'static str,
        value: Option<f64>,
        [least, most]: [f64; 2],
        what: &str,
    ) -> Result<f64, FileError> {
        match self.given(name, value, what)? {
            value if least <= value && value <= most => Ok(value),
            value => Err(self.refuse(name, format!("is {least:?} to {most:?}, not {value:?}"))),
        }
    }

    /// A number from 1 to 10000.
    fn number(
        &self,
        name: &'static str,
        value: Option<u32>,
        [of, what]: [&str; 2],
    ) -> Result<u32, FileError> {
        match self.given(name, value, what)? {
            number @ 1..=10_000 => Ok(number),
            other => Err(self.refuse(name, format!("is 1 to 10000{of}, not {other}"))),
        }
    }

    fn gain(&self) -> Result<f64, FileError> {
        self.finite("gain", self.entry.gain, "the factor")
    }

    fn amperes(&self, what: &str) -> Result<f64, FileError> {
        self.finite("amperes", self.entry.amperes, what)
    }

    fn level(&self, name: &'static str, value: Option<bool>) -> Result<bool, FileError> {
        self.given(name, value, "true or false")
    }

    fn ticks(&self) -> Result<u32, FileError> {
        let of = ["", "a number from 1 to 10000"];
        self.number("ticks", self.entry.ticks, of)
    }

    fn steps(&self) -> Result<u32, FileError> {
        let of = [" full steps", "the number of full steps"];
        self.number("steps", self.entry.steps, of)
    }

    fn counts(&self, what: &str) -> Result<i32, FileError> {
        self.given("counts", self.entry.counts, what)
    }

    /// The greatest error of an encoder [counts].
    fn noise(&self) -> Result<i32, FileError> {
        match self.counts("the greatest error")? {
            counts @ 0.. => Ok(counts),
            other => {
                let reason = format!("must not be less than 0, as {other} is");
                Err(self.refuse("counts", reason))
            }
        }
    }
}

impl FaultEntry {
    pub(super) fn fault(
        &self,
        source: &Source<'_>,
        index: usize,
    ) -> Result<(Option<f64>, FaultKind), FileError> {
        let keys = Keys {
            entry: self,
            source,
            index,
        };
        Ok((keys.at()?, self.kind(&keys)?))
    }

    #[expect(
        clippy::too_many_lines,
        reason = "a list: one arm for each kind of fault"
    )]
    fn kind(&self, keys: &Keys<'_, '_>) -> Result<FaultKind, FileError> {
        Ok(match self.kind {
            Kind::EncoderDead => FaultKind::EncoderDead {
                joint: keys.joint()?,
            },
            Kind::EncoderJump => FaultKind::EncoderJump {
                joint: keys.joint()?,
                counts: keys.counts("the change of the counts")?,
            },
            Kind::EncoderGain => FaultKind::EncoderGain {
                joint: keys.joint()?,
                gain: keys.gain()?,
            },
            Kind::EncoderLate => FaultKind::EncoderLate {
                joint: keys.joint()?,
                ticks: keys.ticks()?,
            },
            Kind::EncoderChannelStuck => FaultKind::EncoderChannelStuck {
                joint: keys.joint()?,
            },
            Kind::EncoderNoise => FaultKind::EncoderNoise {
                joint: keys.joint()?,
                counts: keys.noise()?,
            },
            Kind::IndexStuck => FaultKind::IndexStuck {
                joint: keys.joint()?,
                high: keys.level("high", self.high)?,
            },
            Kind::SwitchStuck => FaultKind::SwitchStuck {
                joint: keys.joint()?,
                pressed: keys.level("pressed", self.pressed)?,
            },
            Kind::MotorDisconnected => FaultKind::MotorDisconnected {
                joint: keys.joint()?,
            },
            Kind::WindingShorted => FaultKind::WindingShorted {
                joint: keys.joint()?,
            },
            Kind::MotorStalled => FaultKind::MotorStalled {
                joint: keys.joint()?,
            },
            Kind::CurrentOffset => FaultKind::CurrentOffset {
                joint: keys.joint()?,
                amperes: keys.amperes("the shift of the sensor's zero [A]")?,
            },
            Kind::CurrentDead => FaultKind::CurrentDead {
                joint: keys.joint()?,
            },
            Kind::CurrentGain => FaultKind::CurrentGain {
                joint: keys.joint()?,
                gain: keys.gain()?,
            },
            Kind::CurrentStuck => FaultKind::CurrentStuck {
                joint: keys.joint()?,
                amperes: keys.amperes("the current that it shows [A]")?,
            },
            Kind::CurrentLate => FaultKind::CurrentLate {
                joint: keys.joint()?,
                ticks: keys.ticks()?,
            },
            Kind::BusVoltage => FaultKind::BusVoltage {
                volts: keys.finite("volts", self.volts, "the new bus voltage [V]")?,
            },
            Kind::BusSensorStuck => FaultKind::BusSensorStuck,
            Kind::BusSensorGain => FaultKind::BusSensorGain { gain: keys.gain()? },
            Kind::BridgeOneDirection => FaultKind::BridgeOneDirection {
                joint: keys.joint()?,
            },
            Kind::BridgeShorted => FaultKind::BridgeShorted {
                joint: keys.joint()?,
            },
            Kind::DutyStuck => FaultKind::DutyStuck {
                joint: keys.joint()?,
            },
            Kind::DriverFault => FaultKind::DriverFault {
                joint: keys.joint()?,
            },
            Kind::DriverFaultStuck => FaultKind::DriverFaultStuck {
                joint: keys.joint()?,
            },
            Kind::DriverFaultOpen => FaultKind::DriverFaultOpen {
                joint: keys.joint()?,
            },
            Kind::EmergencyStop => FaultKind::EmergencyStop,
            Kind::EmergencyStopWelded => FaultKind::EmergencyStopWelded,
            Kind::ContactorWelded => FaultKind::ContactorWelded,
            Kind::BrakeStuck => FaultKind::BrakeStuck {
                joint: keys.joint()?,
            },
            Kind::BrakeLate => FaultKind::BrakeLate {
                joint: keys.joint()?,
                seconds: keys.within(
                    "seconds",
                    self.seconds,
                    [0.0, 10.0],
                    "the additional time [s]",
                )?,
            },
            Kind::BrakeFails => FaultKind::BrakeFails {
                joint: keys.joint()?,
            },
            Kind::CouplingSlips => FaultKind::CouplingSlips {
                joint: keys.joint()?,
                share: keys.within("share", self.share, [0.0, 0.99], "the share that is lost")?,
            },
            Kind::BeltBreaks => FaultKind::BeltBreaks {
                joint: keys.joint()?,
            },
            Kind::StepLost => FaultKind::StepLost {
                joint: keys.joint()?,
                steps: keys.steps()?,
            },
            Kind::PhaseOpen => FaultKind::PhaseOpen {
                joint: keys.joint()?,
            },
            Kind::CanSilent => FaultKind::CanSilent {
                joint: keys.joint()?,
            },
            Kind::CanReset => FaultKind::CanReset {
                joint: keys.joint()?,
            },
            Kind::CanBusOff => FaultKind::CanBusOff,
            Kind::PayloadChanges => FaultKind::PayloadChanges {
                kilograms: keys.finite(
                    "kilograms",
                    self.kilograms,
                    "the change of the payload [kg]",
                )?,
            },
            Kind::ToolCaught => FaultKind::ToolCaught,
            Kind::TicksMissed => FaultKind::TicksMissed {
                ticks: keys.ticks()?,
            },
        })
    }

    /// Refuses a fault of a part that the arm does not have.
    pub(super) fn check_for(
        &self,
        parameters: &Parameters,
        robot: &Robot,
        source: &Source<'_>,
        index: usize,
    ) -> Result<(), FileError> {
        let refused =
            |name, reason: &str| Err(source.refuse(Key::Of("fault", index, name), reason));
        let kind = self.fault(source, index)?.1;
        let (has_steppers, is_on_bus) = (robot.has_steppers(), robot.can_drives().is_some());
        match kind {
            FaultKind::StepLost { .. } | FaultKind::PhaseOpen { .. } if !has_steppers => {
                refused("kind", "needs an arm with steppers")
            }
            _ if kind.is_of_bus() && !is_on_bus => {
                refused("kind", "needs an arm with drives of kind \"can-torque\"")
            }
            _ if is_on_bus && !kind.is_of_torque_drives() => refused(
                "kind",
                "is of brushed motors or steppers, and this arm has drives on a CAN bus",
            ),
            _ if kind.is_of_encoders() && has_steppers => {
                if robot.has_steppers_with_encoders() {
                    return Ok(());
                }
                refused(
                    "kind",
                    "is of encoders, and this arm has steppers without: give both an `encoder_counts`",
                )
            }
            _ if robot.hobby_servos().is_some() && !kind.is_of_hobby_servos() => refused(
                "kind",
                "is of motors with encoders, and this arm has hobby servos",
            ),
            _ if has_steppers && !kind.is_of_steppers() => {
                refused("kind", "is of brushed motors, and this arm has steppers")
            }
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
