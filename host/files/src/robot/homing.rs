//! `[homing]`: how the controller finds the joints' angles.

use super::Robot;
use super::home_method::{self, HomeMethod};
use super::value::positive;
use crate::refusal::{Key, Refusal};
use fivebar_kinematics::five_bar::Joint;
use serde::Deserialize;

/// Where the joints' angles come from, and the search for switches, index pulses or stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
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
    /// Angle by which a joint backs off from its closed switch [rad]; none: the controller's default.
    pub back_off: Option<f64>,
    /// Angles at which the switches close where the angles come from index pulses [rad]; none: half a
    /// turn of the encoder behind `home`.
    pub switch: Option<[f64; 2]>,
    /// Greatest motor current [A]; none: 0.3 of the peak current and what holds the arm's weight.
    pub current: Option<f64>,
}

/// Refuses values that the controller would refuse, with their lines.
pub(super) fn check_search(robot: &Robot) -> Result<(), Refusal> {
    let HomeSearch {
        speed,
        back_off,
        current,
        ..
    } = robot.homing;
    let at_most = |name: &'static str, value: f64, most: f64, of: &str| {
        let key = Key::In("homing", name);
        positive(key, value)?;
        if value <= most {
            return Ok(());
        }
        Err(key.refused(format!("must be at most {most:?}{of}, not {value:?}")))
    };
    let least = |[a, b]: [f64; 2]| a.min(b);
    if let Some(speed) = speed {
        let most = least(robot.limits.max_speed);
        at_most("speed", speed, most, " rad/s, the slower joint's max_speed")?;
    }
    // The controller takes less than 1 rad.
    if let Some(back_off) = back_off {
        at_most("back_off", back_off, 0.99, " rad")?;
    }
    home_method::check_method(robot)?;
    let Some(current) = current else {
        return Ok(());
    };
    let Some(actuators) = &robot.actuators else {
        let reason = "is a motor's: give both [[actuator]], or leave it out";
        return Err(Key::In("homing", "current").refused(reason));
    };
    let peaks = Joint::ALL.map(|joint| robot.limited(joint, actuators[joint]).peak_current);
    at_most(
        "current",
        current,
        least(peaks),
        " A, the least peak current",
    )
}
