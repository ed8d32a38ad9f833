//! `method` of `[homing]`: where the joints' angles come from, and what each method needs.

use super::homing::HomeSearch;
use super::{Actuator, Robot};
use crate::refusal::{Key, Refusal};
use fivebar_firmware::settings::{HomeReference, HomingMethod};
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::EncoderSide;
use serde::Deserialize;
use std::f64::consts::TAU;

/// Where the joints' angles come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HomeMethod {
    /// A search for home switches.
    #[default]
    Switch,
    /// A search for home switches, and for the encoders' index pulses from there.
    Index,
    /// A search for hard stops, by the motors' currents.
    HardStop,
    /// Encoders that know their angle.
    Absolute,
    /// The arm is put at its home angles by hand.
    Given,
}

/// Time after which a stop is believed [s].
const STOP_TIME: f64 = 0.01;

/// What the controller knows of the method.
pub(super) fn reference(search: &HomeSearch, tick_rate: f64) -> HomeReference {
    let method = match search.method {
        HomeMethod::Switch => HomingMethod::Switch,
        HomeMethod::Index => HomingMethod::Index,
        HomeMethod::HardStop => HomingMethod::HardStop,
        HomeMethod::Absolute => HomingMethod::Absolute,
        HomeMethod::Given => HomingMethod::Given,
    };
    let samples = match search.method {
        // `as` saturates.
        HomeMethod::HardStop => ((STOP_TIME * tick_rate) as u8).max(1),
        HomeMethod::Switch | HomeMethod::Index | HomeMethod::Absolute | HomeMethod::Given => {
            HomeReference::SWITCHES.samples
        }
    };
    HomeReference {
        method,
        samples: search.samples.unwrap_or(samples),
    }
}

/// Refuses a method that does not fit the arm, and keys that it does not use.
pub(super) fn check_method(robot: &Robot) -> Result<(), Refusal> {
    let search = &robot.homing;
    let key = |name| Key::In("homing", name);
    if search.samples == Some(0) {
        return Err(key("samples").refused("must be 1 to 255, not 0"));
    }
    if search.switch.is_some() && search.method != HomeMethod::Index {
        let reason = "is of the method \"index\": with any other, switches close at home";
        return Err(key("switch").refused(reason));
    }
    match search.method {
        HomeMethod::Switch => Ok(()),
        HomeMethod::Index => super::home_index::check_index(robot),
        HomeMethod::HardStop => hard_stop(robot),
        HomeMethod::Absolute => {
            nothing_searched(search)?;
            absolute(robot)
        }
        HomeMethod::Given => nothing_searched(search),
    }
}

/// Refuses the keys of a search.
fn nothing_searched(search: &HomeSearch) -> Result<(), Refusal> {
    let given = [
        ("samples", search.samples.is_some()),
        ("forward", search.forward.is_some()),
        ("speed", search.speed.is_some()),
        ("back_off", search.back_off.is_some()),
        ("current", search.current.is_some()),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => {
            let reason = "is of a search, and this method moves nothing";
            Err(Key::In("homing", name).refused(reason))
        }
        None => Ok(()),
    }
}

/// A stop is felt at no more than the continuous current, and lies just behind the range of the angles.
fn hard_stop(robot: &Robot) -> Result<(), Refusal> {
    let method = Key::In("homing", "method");
    let Some(actuators) = &robot.actuators else {
        return Err(method.refused("needs both [[actuator]]: it feels motor currents"));
    };
    let least = |values: [f64; 2]| values[0].min(values[1]);
    let continuous = least(Joint::ALL.map(|j| robot.limited(j, actuators[j]).continuous_current));
    let current = robot.homing.current.unwrap_or(f64::INFINITY);
    if current > continuous {
        let reason = format!(
            "must be given for hard stops, {continuous:?} A at most, the least continuous current"
        );
        return Err(Key::In("homing", "current").refused(reason));
    }
    let samples = reference(&robot.homing, robot.control.tick_rate).samples;
    let felt_in = f64::from(samples) / robot.control.tick_rate;
    let fastest = 0.5 * robot.protection.following_error / felt_in;
    if robot.homing_speed() > fastest {
        let reason = format!(
            "must be at most {fastest:.3} rad/s for hard stops: half of following_error within samples"
        );
        return Err(Key::In("homing", "speed").refused(reason));
    }
    for joint in Joint::ALL {
        let [low, high] = robot.limits.angle[joint];
        let home = robot.home[joint];
        let (end, beyond) = if robot.homes_forward(joint) {
            (high, high - home)
        } else {
            (low, home - low)
        };
        let back_off = robot.back_off();
        if beyond > back_off {
            let reason = format!(
                "of {joint} must end before its hard stop, which lies {back_off:?} rad, the \
                 back_off, behind home: not at {end:?} rad"
            );
            return Err(Key::In("limits", "angle").refused(reason));
        }
    }
    Ok(())
}

/// An absolute encoder shows one angle only if it turns with its joint, and that by one turn at most.
fn absolute(robot: &Robot) -> Result<(), Refusal> {
    for joint in Joint::ALL {
        let Some(actuators) = &robot.actuators else {
            continue;
        };
        let actuator = &actuators[joint];
        let is_servo = actuator.hobby_servo().is_some();
        let Actuator {
            gear_ratio,
            encoder_side,
            ..
        } = actuator;
        if !is_servo && *encoder_side == EncoderSide::Motor && gear_ratio.abs() != 1.0 {
            let key = Key::Of("actuator", joint.index(), "encoder_side");
            let reason = "must be \"joint\" for absolute encoders: a motor has the same counts in each \
                          of its turns";
            return Err(key.refused(reason));
        }
        let [low, high] = robot.limits.angle[joint];
        if high - low > TAU {
            let reason = "must be a turn at most for absolute encoders, for each joint";
            return Err(Key::In("limits", "angle").refused(reason));
        }
    }
    Ok(())
}
