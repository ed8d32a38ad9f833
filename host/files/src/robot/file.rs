//! The robot file: its sections, and what each value of them must be by itself.

use super::actuator_file::ActuatorFile;
use super::homing::HomeSearch;
use super::links::LinkFile;
use super::sections::{
    ControlFile, Crossing, Limits, Protection, Supply, ToleranceFile, Tool, ToolLimits,
};
use super::tool_output::ToolOutputFile;
use super::value::{
    LEAST_ACCELERATION, LEAST_JERK, LEAST_SPEED, at_least, finite, increasing, near, not_negative,
    positive,
};
use crate::refusal::{Key, Refusal, Refusals};
use fivebar_firmware::settings::{AdvancedSettings, LONGEST_STOP};
use fivebar_plant::contact::Contact;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RobotFile {
    pub(super) name: String,
    pub(super) gravity: [f64; 2],
    pub(super) base: f64,
    /// Required if the links have masses.
    pub(super) payload: Option<f64>,
    #[serde(default = "elbows_out")]
    pub(super) working_mode: [String; 2],
    pub(super) home: Option<[f64; 2]>,
    pub(super) link: Vec<LinkFile>,
    #[serde(default)]
    pub(super) actuator: Vec<ActuatorFile>,
    #[serde(default)]
    pub(super) tool: Tool,
    #[serde(default)]
    pub(super) tool_output: ToolOutputFile,
    #[serde(default)]
    pub(super) macros: BTreeMap<String, String>,
    #[serde(default)]
    pub(super) limits: Limits,
    #[serde(default)]
    pub(super) motion: ToolLimits,
    #[serde(default)]
    pub(super) control: ControlFile,
    #[serde(default)]
    pub(super) supply: Supply,
    #[serde(default)]
    pub(super) protection: Protection,
    #[serde(default)]
    pub(super) homing: HomeSearch,
    #[serde(default)]
    pub(super) tolerance: ToleranceFile,
    #[serde(default)]
    pub(super) contact: Contact,
    #[serde(default)]
    pub(super) crossing: Crossing,
    #[serde(default)]
    pub(super) advanced: AdvancedSettings,
}

fn elbows_out() -> [String; 2] {
    ["right".into(), "left".into()]
}

impl RobotFile {
    /// Checks the values of the file itself.
    pub(super) fn check_top(&self, refusals: &mut Refusals) {
        refusals.note(name(&self.name));
        refusals.note(finite(Key::Top("gravity"), self.gravity));
        let payload = self.payload.unwrap_or_default();
        refusals.note(not_negative(Key::Top("payload"), payload));
    }

    /// Checks home, and the values of the sections that are numbers.
    pub(super) fn check_sections(&self, refusals: &mut Refusals) {
        let Self {
            tool,
            limits,
            motion,
            supply,
            protection,
            ..
        } = self;
        let control = self.control.given();
        refusals.note(contact(&self.contact));
        refusals.note(finite(Key::Top("home"), self.home.unwrap_or_default()));
        let drag = Key::In("crossing", "drag");
        refusals.note(not_negative(drag, self.crossing.drag));
        refusals.note(near(Key::In("tool", "offset"), tool.offset));
        for range in limits.angle {
            refusals.note(angles(range));
        }
        if let Some(range) = supply.range {
            refusals.note(increasing(Key::In("supply", "range"), range));
        }
        for (key, of_joints, least) in [
            ("max_speed", limits.max_speed, (LEAST_SPEED, "rad/s")),
            (
                "max_acceleration",
                limits.max_acceleration,
                (LEAST_ACCELERATION, "rad/s²"),
            ),
        ] {
            for value in of_joints {
                refusals.note(at_least(Key::In("limits", key), value, least));
            }
        }
        for value in limits.max_torque.unwrap_or([1.0; 2]) {
            refusals.note(positive(Key::In("limits", "max_torque"), value));
        }
        for (key, value, least) in [
            ("max_speed", motion.max_speed, (LEAST_SPEED, "m/s")),
            (
                "max_acceleration",
                motion.max_acceleration,
                (LEAST_ACCELERATION, "m/s²"),
            ),
            ("max_jerk", motion.max_jerk, (LEAST_JERK, "m/s³")),
        ] {
            refusals.note(at_least(Key::In("motion", key), value, least));
        }
        self.check_stops(refusals);
        for (section, key, value) in [
            ("control", "tick_rate", control.tick_rate),
            ("control", "bandwidth", control.bandwidth),
            ("control", "damping", control.damping),
            ("control", "observer_bandwidth", control.observer_bandwidth),
            ("control", "current_bandwidth", control.current_bandwidth),
            ("supply", "voltage", supply.voltage),
            (
                "supply",
                "voltage_per_code",
                supply.voltage_per_code.unwrap_or(1.0),
            ),
            ("protection", "following_error", protection.following_error),
            ("protection", "over_speed", protection.over_speed),
            ("protection", "over_current", protection.over_current),
            ("protection", "command_timeout", protection.command_timeout),
        ] {
            refusals.note(positive(Key::In(section, key), value));
        }
        for (section, key, value) in [
            ("motion", "corner_tolerance", motion.corner_tolerance),
            ("control", "integral_rate", control.integral_rate),
        ] {
            refusals.note(not_negative(Key::In(section, key), value));
        }
        if !(0.0..1.0).contains(&limits.singularity_margin) {
            let reason = format!("is a sine: in 0…1, not {:?}", limits.singularity_margin);
            refusals.add(Key::In("limits", "singularity_margin"), reason);
        }
    }

    /// The controller's own rules: a stop from full speed takes at most [`LONGEST_STOP`].
    fn check_stops(&self, refusals: &mut Refusals) {
        let Self { limits, motion, .. } = self;
        let longest = f64::from(LONGEST_STOP);
        let mut gains = vec![(
            ("motion", "max_acceleration"),
            motion.max_acceleration,
            1.5 / longest * motion.max_speed,
            "m/s²",
        )];
        let jerk = 6.0 / (longest * longest) * motion.max_speed;
        gains.push((("motion", "max_jerk"), motion.max_jerk, jerk, "m/s³"));
        for (speed, acceleration) in limits.max_speed.into_iter().zip(limits.max_acceleration) {
            let key = ("limits", "max_acceleration");
            gains.push((key, acceleration, 1.5 / longest * speed, "rad/s²"));
        }
        for ((section, name), value, least, unit) in gains {
            let key = Key::In(section, name);
            let follows = refusals.has(key) || refusals.has(Key::In(section, "max_speed"));
            if value < least && !follows {
                let reason = format!(
                    "is {value:?} {unit}: a stop from max_speed would take more than 10 s; at least \
                     {least:.4} {unit} is needed"
                );
                refusals.add(key, reason);
            }
        }
    }
}

/// Least and greatest angle of a joint [rad].
fn angles(range: [f64; 2]) -> Result<(), Refusal> {
    let key = Key::In("limits", "angle");
    increasing(key, range)?;
    if range.iter().any(|angle| angle.abs() > TAU) {
        return Err(key.refused(format!("is in radians, within ±2π, not {range:?}")));
    }
    Ok(())
}

fn contact(contact: &Contact) -> Result<(), Refusal> {
    let Some(invalid) = contact.first_invalid() else {
        return Ok(());
    };
    let reason = format!("{}, not {:?}", invalid.must, invalid.value);
    Err(Key::In("contact", invalid.key).refused(reason))
}

fn name(name: &str) -> Result<(), Refusal> {
    let reason = if name.trim().is_empty() {
        "must not be empty"
    } else if name.contains(char::is_control) {
        // XML and tables cannot hold control characters.
        "must be one line of plain characters"
    } else {
        return Ok(());
    };
    Err(Key::Top("name").refused(reason))
}
