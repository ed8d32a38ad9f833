//! `[[fault]]` of a scenario file: a fault to inject, and its time.

use crate::input::source::{FileError, Key, Source};
use fivebar_plant::FaultKind;
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
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    EncoderDead,
    EncoderJump,
    SwitchStuck,
    MotorDisconnected,
    MotorStalled,
    CurrentOffset,
    BusVoltage,
    DriverFault,
    EmergencyStop,
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
        let joint = || match self.joint {
            Some(1) => Ok(0),
            Some(4) => Ok(1),
            Some(other) => Err(source.refuse(key("joint"), format!("is 1 or 4, not {other}"))),
            None => Err(missing("joint", "1 or 4")),
        };
        let finite = |name, value: Option<f64>, what: &str| match value {
            Some(value) if value.is_finite() => Ok(value),
            Some(value) => Err(source.refuse(key(name), format!("must be finite, not {value:?}"))),
            None => Err(missing(name, what)),
        };
        let kind = match self.kind {
            Kind::EncoderDead => FaultKind::EncoderDead { joint: joint()? },
            Kind::EncoderJump => FaultKind::EncoderJump {
                joint: joint()?,
                counts: self
                    .counts
                    .ok_or_else(|| missing("counts", "the change of the counts"))?,
            },
            Kind::SwitchStuck => FaultKind::SwitchStuck {
                joint: joint()?,
                pressed: self
                    .pressed
                    .ok_or_else(|| missing("pressed", "true or false"))?,
            },
            Kind::MotorDisconnected => FaultKind::MotorDisconnected { joint: joint()? },
            Kind::MotorStalled => FaultKind::MotorStalled { joint: joint()? },
            Kind::CurrentOffset => FaultKind::CurrentOffset {
                joint: joint()?,
                amperes: finite(
                    "amperes",
                    self.amperes,
                    "the shift of the sensor's zero [A]",
                )?,
            },
            Kind::BusVoltage => FaultKind::BusVoltage {
                volts: finite("volts", self.volts, "the new bus voltage [V]")?,
            },
            Kind::DriverFault => FaultKind::DriverFault { joint: joint()? },
            Kind::EmergencyStop => FaultKind::EmergencyStop,
            Kind::TicksMissed => FaultKind::TicksMissed {
                ticks: match self.ticks {
                    Some(ticks @ 1..=10_000) => ticks,
                    Some(other) => {
                        let reason = format!("is 1 to 10000, not {other}");
                        return Err(source.refuse(key("ticks"), reason));
                    }
                    None => return Err(missing("ticks", "a number from 1 to 10000")),
                },
            },
        };
        Ok((self.at, kind))
    }
}
