//! Checks that a robot's values are consistent and that its controller accepts them. Errors
//! name the keys of the robot file, from which the settings are made.

use super::settings::ADC_CODES;
use super::{Actuator, Robot, plausible};
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
    plausible::check(source, robot)?;
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
    let limited = robot.drives().ok();
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
        if let Some(invalid) = torque_constant(robot, index, motor) {
            return Some(invalid);
        }
        // Zero current is in the middle of the codes, and one code more must show the fault.
        let over_current = robot.over_current(limited.as_ref()?);
        let needed = over_current / (0.5 * ADC_CODES - 2.5);
        let per_code = motor.current_per_code.filter(|&amperes| amperes < needed)?;
        let must = format!(
            "must be at least {needed:.3e} A for 12 bits to show the over-current of \
             {over_current:.3} A"
        );
        Some((key("current_per_code"), written(per_code), "A", must))
    })
}

/// Least and greatest no-load speed, in greatest speeds of the joint. A motor is chosen within a
/// factor of a few; a value in another unit is wrong by a thousand.
const NO_LOAD: [f64; 2] = [0.2, 500.0];

/// The torque constant must suit the joint's greatest speed: it is also the back-EMF constant.
fn torque_constant(robot: &Robot, index: usize, motor: &Actuator) -> Option<InvalidValue> {
    let voltage = robot.supply.voltage;
    let max_speed = robot.limits.max_speed[index];
    let no_load = |constant: f64| voltage / (constant * motor.gear_ratio.abs());
    let [least, greatest] = NO_LOAD;
    let suits =
        |constant: f64| (least * max_speed..=greatest * max_speed).contains(&no_load(constant));
    let written_constant = motor.torque_constant;
    if suits(written_constant) {
        return None;
    }
    let meant = [written_constant / 1e3, written_constant * 1e3];
    let meant = meant.into_iter().find(|&constant| suits(constant));
    let meant = meant.map_or_else(String::new, |constant| {
        let rounded = (constant * 1e9).round() / 1e9;
        format!(" ({rounded} N·m/A meant?)")
    });
    let must = format!(
        "must be {:.2e} to {:.2e} N·m/A, so that the joint reaches a fifth to 500 times its \
         `max_speed` without load{meant}",
        no_load(greatest * max_speed),
        no_load(least * max_speed),
    );
    let key = Key::Of("actuator", index, "torque_constant");
    Some((key, written(written_constant), "N·m/A", must))
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

/// The key and value of the robot file behind an invalid field of a motor or its joint. The
/// fields of an ideal torque source are made from the supply's voltage and the limits.
fn motor_setting(
    robot: &Robot,
    index: usize,
    field: AxisField,
    error: &str,
) -> Option<InvalidValue> {
    let (_, must) = error.split_once(" must ")?;
    let (name, value) = match (field, robot.actuators) {
        (AxisField::MaxSpeed, _) => ("max_speed", robot.limits.max_speed[index]),
        (AxisField::MaxAcceleration, _) => {
            ("max_acceleration", robot.limits.max_acceleration[index])
        }
        (_, None) => {
            let must = format!("makes an ideal motor out of bounds: {error}");
            let voltage = written(robot.supply.voltage);
            return Some((Key::In("supply", "voltage"), voltage, "V", must));
        }
        (_, Some(motors)) => {
            let motor = &motors[index];
            let (name, value) = match field {
                AxisField::GearRatio => ("gear_ratio", motor.gear_ratio),
                AxisField::EncoderLatency => ("encoder_latency", motor.encoder_latency),
                AxisField::RotorInertia => ("rotor_inertia", motor.rotor_inertia),
                AxisField::TorqueConstant => ("torque_constant", motor.torque_constant),
                AxisField::Resistance => ("resistance", motor.resistance),
                AxisField::Inductance => ("inductance", motor.inductance),
                AxisField::ViscousFriction => ("viscous_friction", motor.viscous_friction),
                AxisField::CoulombFriction => ("coulomb_friction", motor.coulomb_friction),
                AxisField::ThermalTimeConstant => {
                    ("thermal_time_constant", motor.thermal_time_constant)
                }
                AxisField::CurrentPerCode if motor.current_per_code.is_some() => {
                    ("current_per_code", motor.current_per_code?)
                }
                _ => ("peak_current", motor.peak_current),
            };
            let must = format!("must {must}");
            return Some((Key::Of("actuator", index, name), written(value), "", must));
        }
    };
    Some((
        Key::In("limits", name),
        written(value),
        "",
        format!("must {must}"),
    ))
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
        SettingsError::Axis(joint, field) => {
            return motor_setting(robot, usize::from(joint != 1), field, &error.to_string());
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
            "is times `max_speed` of [limits], and must be 1 to 5".into(),
        )),
        Field::OverCurrent => Some((
            Key::In("protection", "over_current"),
            written(protection.over_current),
            "",
            "is times `peak_current`, and must be 1 to 5".into(),
        )),
        Field::BusVoltage => Some((
            Key::In("supply", "range"),
            written(robot.bus_range()[0]),
            "V",
            "must begin at a fiftieth of its end or above".into(),
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
