//! Checks that a robot's values are consistent and that its controller accepts them. Errors
//! name the keys of the robot file, from which the settings are made.

use super::Robot;
use super::settings::ADC_CODES;
use crate::input::source::{FileError, Key, Source};
use fivebar_firmware::settings::{AxisField, Field, SettingsError};

/// Least and greatest time constant of a winding [s]; real ones have 20 µs to 50 ms. Beyond
/// them single precision is not enough for the current loop.
const WINDING: [f64; 2] = [1e-6, 1.0];

/// A key, its value as text, the value's unit, and what the value must be.
type InvalidValue = (Key, String, &'static str, String);

/// Checks values that are valid on their own.
pub(super) fn check(source: &Source<'_>, robot: &Robot) -> Result<(), FileError> {
    let invalid = motors(robot).or_else(|| bus(robot));
    if let Some(invalid) = invalid {
        return Err(refusal(source, invalid));
    }
    // An arm with lengths only has no controller.
    let Ok(settings) = robot.settings() else {
        return Ok(());
    };
    match settings.check() {
        // An arm without a pose to control can still be analysed.
        Ok(_)
        | Err(SettingsError::Geometry(_) | SettingsError::Inertia(_) | SettingsError::NoPose) => {
            Ok(())
        }
        Err(error) => Err(match setting(robot, error) {
            Some(invalid) => refusal(source, invalid),
            None => FileError {
                file: source.file.into(),
                line: None,
                reason: format!("the controller refuses this robot: {error}"),
            },
        }),
    }
}

/// Why the controller refuses a robot whose file is valid, with the keys of the file.
pub(crate) fn robot_file_message(error: SettingsError) -> String {
    match error {
        SettingsError::NoPose => {
            "no pose in its `working_mode` and within the `angle` of [limits] keeps the \
             `singularity_margin` of [limits]"
                .into()
        }
        other => other.to_string(),
    }
}

fn refusal(source: &Source<'_>, (key, value, unit, must): InvalidValue) -> FileError {
    let space = if unit.is_empty() { "" } else { " " };
    let default = if source.holds(key) {
        ""
    } else {
        ", the default"
    };
    source.refuse(key, format!("{must}, not {value}{space}{unit}{default}"))
}

fn written(value: f64) -> String {
    format!("{value:?}")
}

fn motors(robot: &Robot) -> Option<InvalidValue> {
    let motors = robot.actuators.iter().flatten().enumerate();
    motors.into_iter().find_map(|(index, motor)| {
        let key = |name| Key::Of("actuator", index, name);
        let [least, greatest] = WINDING;
        let winding = motor.inductance / motor.resistance;
        if !(least..=greatest).contains(&winding) {
            let must = format!(
                "over `resistance`, the winding's time constant, must be {least:e} to \
                 {greatest} s"
            );
            return Some((key("inductance"), format!("{winding:.3e}"), "s", must));
        }
        if motor.continuous_current > motor.peak_current {
            let must = format!("must be at most `peak_current`, {} A", motor.peak_current);
            let current = written(motor.continuous_current);
            return Some((key("continuous_current"), current, "A", must));
        }
        // Zero current is in the middle of the codes.
        let needed = robot.limited(index, *motor).peak_current / (0.5 * ADC_CODES - 1.0);
        let per_code = motor.current_per_code.filter(|&amperes| amperes < needed)?;
        let must = format!("must be at least {needed:.3e} A for 12 bits to hold the peak current");
        Some((key("current_per_code"), written(per_code), "A", must))
    })
}

/// The converter must resolve the bus's range, and also a voltage above it.
fn bus(robot: &Robot) -> Option<InvalidValue> {
    let voltage = robot.supply.voltage;
    let [low, high] = robot.bus_range();
    if low <= 0.0 {
        let must = "must begin above 0 V".into();
        return Some((Key::In("supply", "range"), written(low), "V", must));
    }
    if !(low..=high).contains(&voltage) {
        let must = format!("must lie within `range`, {low} to {high} V");
        let voltage = written(voltage);
        return Some((Key::In("supply", "voltage"), voltage, "V", must));
    }
    let per_code = robot.voltage_per_code();
    let [least, greatest] = [high / (ADC_CODES - 1.0), 0.1 * (high - low)];
    if (least..=greatest).contains(&per_code) {
        return None;
    }
    let must = format!(
        "must be {least:.3e} to {greatest:.3e} V, so that 12 bits show when the bus leaves {low} \
         to {high} V"
    );
    let key = Key::In("supply", "voltage_per_code");
    Some((key, written(per_code), "V", must))
}

/// The key and value of the robot file behind an error of the settings; none for errors that
/// the checks of the file already exclude.
fn setting(robot: &Robot, error: SettingsError) -> Option<InvalidValue> {
    let Robot {
        control,
        limits,
        protection,
        ..
    } = robot;
    let field = match error {
        SettingsError::Axis(joint, AxisField::EncoderCounts) => {
            let index = usize::from(joint != 1);
            let motor = &robot.actuators?[index];
            let must = format!(
                "times `gear_ratio` must be at most 4194304 per turn of the joint, the resolution \
                 of single precision: at most {:.0} with this gear",
                4_194_304.0 / motor.gear_ratio.abs()
            );
            let key = Key::Of("actuator", index, "encoder_counts");
            return Some((key, motor.encoder_counts.to_string(), "", must));
        }
        SettingsError::Field(field) => field,
        _ => return None,
    };
    let in_control =
        |name, value, unit, must| Some((Key::In("control", name), written(value), unit, must));
    let rate = "rad/s";
    match field {
        Field::TickRate => {
            let must = "must be 100 to 50000 Hz".into();
            in_control("tick_rate", control.tick_rate, "Hz", must)
        }
        Field::CurrentBandwidth => {
            let greatest = 0.35 * control.tick_rate;
            let must = format!("must be at most 0.35 times `tick_rate`, {greatest} rad/s");
            in_control("current_bandwidth", control.current_bandwidth, rate, must)
        }
        Field::Bandwidth => {
            let greatest = 0.25 * control.current_bandwidth;
            let must =
                format!("must be at most a quarter of `current_bandwidth`, {greatest} rad/s");
            in_control("bandwidth", control.bandwidth, rate, must)
        }
        Field::Damping => in_control("damping", control.damping, "", "must be 0.2 to 2".into()),
        Field::IntegralRate => {
            let greatest = 0.25 * control.bandwidth;
            let must = format!("must be at most a quarter of `bandwidth`, {greatest} rad/s");
            in_control("integral_rate", control.integral_rate, rate, must)
        }
        Field::ObserverBandwidth => {
            let [least, greatest] = [2.0 * control.bandwidth, control.tick_rate];
            let must = format!(
                "must lie between twice `bandwidth` and `tick_rate`, {least} to {greatest} rad/s"
            );
            in_control("observer_bandwidth", control.observer_bandwidth, rate, must)
        }
        Field::SingularityMargin => Some((
            Key::In("limits", "singularity_margin"),
            written(limits.singularity_margin),
            "",
            "must be more than 0 and less than 1".into(),
        )),
        Field::FollowingError => Some((
            Key::In("protection", "following_error"),
            written(protection.following_error),
            "rad",
            "must be less than 1 rad".into(),
        )),
        Field::OverSpeed => Some((
            Key::In("protection", "over_speed"),
            written(protection.over_speed),
            "",
            "is times `max_speed` of [limits], and must be at least 1".into(),
        )),
        Field::OverCurrent => Some((
            Key::In("protection", "over_current"),
            written(protection.over_current),
            "",
            "is times `peak_current`, and must be at least 1".into(),
        )),
        Field::CommandTimeout => Some((
            Key::In("protection", "command_timeout"),
            written(protection.command_timeout),
            "s",
            format!("must be a tick, {:e} s, to 60 s", 1.0 / control.tick_rate),
        )),
        _ => None,
    }
}
