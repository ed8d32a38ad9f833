//! `[homing]`: how the controller finds the joints' angles.

use super::Robot;
use super::file::default_of;
use super::home_method::{self, HomeMethod};
use super::value::positive;
use crate::source::{FileError, Key, Source};
use fivebar_firmware::settings::Field;
use fivebar_kinematics::five_bar::Joint;
use serde::Deserialize;

/// Where the joints' angles come from, and the search for switches, index pulses or stops.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HomeSearch {
    /// Where the angles come from.
    pub method: HomeMethod,
    /// Equal samples in a row after which a switch or a stop is believed; none: 8 for a switch, those of
    /// 10 ms for a stop.
    pub samples: Option<u8>,
    /// Whether joint 1 and joint 4 approach their switches with a growing angle; none: towards the
    /// limit of `limits.angle` that is nearer to the switch.
    pub forward: Option<[bool; 2]>,
    /// Speed of the first approach [rad/s], the second has an eighth of it; none: 0.02 of the slower
    /// joint's greatest speed.
    pub speed: Option<f64>,
    /// Angle by which a joint backs off from its closed switch [rad].
    pub back_off: f64,
    /// Angles at which the switches close where the angles come from index pulses [rad]; none: half a
    /// turn of the encoder behind `home`.
    pub switch: Option<[f64; 2]>,
    /// Greatest motor current [A]; none: 0.3 of the peak current and what holds the arm's weight.
    pub current: Option<f64>,
}

impl Default for HomeSearch {
    fn default() -> Self {
        Self {
            method: HomeMethod::Switch,
            samples: None,
            forward: None,
            speed: None,
            back_off: default_of(&Field::HomingBackOff.row()),
            switch: None,
            current: None,
        }
    }
}

/// Refuses values that the controller would refuse, with their lines.
pub(super) fn check(source: &Source<'_>, robot: &Robot) -> Result<(), FileError> {
    let HomeSearch {
        speed,
        back_off,
        current,
        ..
    } = robot.homing;
    let at_most = |name: &'static str, value: f64, most: f64, of: &str| {
        let key = Key::In("homing", name);
        if positive(source, key, value)? <= most {
            return Ok(());
        }
        Err(source.refuse(key, format!("must be at most {most:?}{of}, not {value:?}")))
    };
    let least = |[a, b]: [f64; 2]| a.min(b);
    if let Some(speed) = speed {
        let most = least(robot.limits.max_speed);
        at_most("speed", speed, most, " rad/s, the slower joint's max_speed")?;
    }
    // The controller takes less than 1 rad.
    at_most("back_off", back_off, 0.99, " rad")?;
    home_method::check(source, robot)?;
    let Some(current) = current else {
        return Ok(());
    };
    let Some(actuators) = &robot.actuators else {
        let reason = "is a motor's: give both [[actuator]], or leave it out";
        return Err(source.refuse(Key::In("homing", "current"), reason));
    };
    let peaks = Joint::ALL.map(|joint| robot.limited(joint, actuators[joint]).peak_current);
    at_most(
        "current",
        current,
        least(peaks),
        " A, the least peak current",
    )
}
