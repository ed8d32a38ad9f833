//! Checks that a robot's values are consistent and that its controller accepts them. Errors
//! name the keys of the robot file, from which the settings are made.

use super::can_torque::can_drives_fit;
use super::hobby_servo::servos_fit;
use super::homing::check_search;
use super::plausible::check_sizes;
use super::settings::ADC_CODES;
use super::stepper::steppers_fit;
use super::{Actuator, Drive, Robot};
use crate::refusal::{Key, Refusal, Refusals};
use crate::source::Source;
use fivebar_firmware::settings::{AxisField, Row, SettingsError};
use fivebar_kinematics::five_bar::Joint;

/// Least and greatest time constant of a winding [s]; real ones have 20 µs to 50 ms. Beyond
/// them single precision is not enough for the current loop.
const WINDING: [f64; 2] = [1e-6, 1.0];

/// A key, its value as text, the value's unit, and what the value must be.
type InvalidValue = (Key, String, &'static str, String);

/// Checks values that are valid on their own.
pub(super) fn check_together(source: &Source<'_>, robot: &Robot) -> Result<(), Refusal> {
    let kinds = robot.actuators.map(|both| both.map(|it| it.kind()));
    if kinds.is_some_and(|[first, second]| first != second) {
        let reason = "must be the same for both joints";
        return Err(Key::Of("actuator", 1, "kind").refused(reason));
    }
    let mut refusals = Refusals::default();
    refusals.note(check_search(robot));
    if source.holds(Key::Top("home")) {
        refusals.note(home_fits(robot));
    }
    let weights = robot.greatest_weights();
    steppers_fit(robot, weights, &mut refusals);
    can_drives_fit(robot, weights, &mut refusals);
    servos_fit(robot, weights, &mut refusals);
    for invalid in motors(robot).into_iter().chain(bus(robot)) {
        refuse(source, invalid, &mut refusals);
    }
    check_sizes(source, robot, &mut refusals);
    controller_accepts(source, robot, &mut refusals);
    refusals.done()
}

/// Checks that home is a pose in the working mode and within the joint limits.
fn home_fits(robot: &Robot) -> Result<(), Refusal> {
    let [theta1, theta4] = robot.home;
    if !robot.limits.contain(robot.home) {
        let [limits1, limits4] = robot.limits.angle;
        let reason = format!(
            "[{theta1:?}, {theta4:?}] rad is outside the joints' limits {limits1:.4?} and {limits4:.4?} rad"
        );
        return Err(Key::Top("home").refused(reason));
    }
    robot.home_pose().map(|_| ()).map_err(|_| {
        let reason =
            format!("[{theta1:?}, {theta4:?}] rad: the arm has no pose there in its working mode");
        Key::Top("home").refused(reason)
    })
}

/// Checks the settings that are made from the values.
fn controller_accepts(source: &Source<'_>, robot: &Robot, refusals: &mut Refusals) {
    // An arm with lengths only has no controller.
    let Ok(settings) = robot.settings() else {
        return;
    };
    for error in settings.faults() {
        // Of [[actuator]] the first joint's, unless it is of one joint.
        let (joint, row, value, bounds) = match error {
            // An arm without a pose to control can still be analysed.
            SettingsError::Geometry(_) | SettingsError::Inertia(_) | SettingsError::NoPose => {
                continue;
            }
            SettingsError::Axis(number, field) => {
                let Some(joint) = Joint::numbered(number) else {
                    continue;
                };
                let axis = &settings.axes[joint];
                (joint, field.row(), field.value(axis), field.bounds(axis))
            }
            SettingsError::Field(field) => {
                let bounds = field.bounds(&settings);
                let value = field.value(&settings);
                (Joint::Joint1, field.row(), value, bounds)
            }
            _ => continue,
        };
        let invalid = match (key_of(&row, joint), &robot.actuators) {
            // An ideal torque source is made from the supply's voltage and the limits.
            (Key::Of(..), None) => {
                let must = format!("makes an ideal motor out of bounds: {error}");
                let voltage = written(robot.supply.voltage);
                (Key::In("supply", "voltage"), voltage, "V", must)
            }
            (key, Some(motors)) if row == AxisField::EncoderCounts.row() => {
                let motor = &motors[joint];
                let must = format!(
                    "times `gear_ratio` must be at most 4194304 per turn of the joint, the \
                     resolution of single precision: at most {:.0} with this gear",
                    4_194_304.0 / motor.gear_ratio.abs()
                );
                (key, motor.encoder_counts.to_string(), "", must)
            }
            (key, _) => {
                // As the file has it, unless the setting is made from it and others.
                let text = source.number_of(key, joint.index());
                let text = text.filter(|(number, _)| (*number as f32).abs() == value.abs());
                let text = text.map_or_else(|| format!("{value:?}"), |(_, text)| text);
                (key, text, row.unit, must(&row, bounds))
            }
        };
        let (key, ..) = invalid;
        // After other refusals, what the file leaves out follows from them.
        if !refusals.has(key) && (refusals.is_empty() || source.holds(key)) {
            refuse(source, invalid, refusals);
        }
    }
}

/// The key of a robot file that decides a setting.
fn key_of(row: &Row, joint: Joint) -> Key {
    match row.key.split_once('.') {
        None => Key::Top(row.key),
        Some((section @ "actuator", name)) => Key::Of(section, joint.index(), name),
        Some((section, name)) => Key::In(section, name),
    }
}

/// What a setting must be. Where other keys bound it, also between which numbers.
fn must(row: &Row, [least, greatest]: [f32; 2]) -> String {
    let must = row.must.to_string();
    let space = if row.unit.is_empty() { "" } else { " " };
    if !must.contains('`') || !greatest.is_finite() {
        must
    } else if least > f32::MIN_POSITIVE {
        format!("{must}, {least} to {greatest}{space}{}", row.unit)
    } else {
        format!("{must}, {greatest}{space}{}", row.unit)
    }
}

/// Why the controller refuses a robot whose file is valid, with the keys of the file.
pub fn robot_file_message(error: SettingsError) -> String {
    match error {
        SettingsError::NoPose => {
            "no pose in its `working_mode` and within the `angle` of [limits] keeps the \
             `singularity_margin` of [limits]"
                .into()
        }
        other => other.to_string(),
    }
}

fn refuse(source: &Source<'_>, (key, value, unit, must): InvalidValue, refusals: &mut Refusals) {
    let space = if unit.is_empty() { "" } else { " " };
    let default = if source.holds(key) {
        ""
    } else {
        ", the default"
    };
    refusals.add(
        key,
        format_args!("{must}, not {value}{space}{unit}{default}"),
    );
}

fn written(value: f64) -> String {
    format!("{value:?}")
}

/// The first such value of each motor.
fn motors(robot: &Robot) -> Vec<InvalidValue> {
    let limited = robot.drives().ok();
    let motors = robot.actuators.iter().flatten().enumerate();
    let invalid = motors.filter_map(|(index, motor)| {
        let key = |name| Key::Of("actuator", index, name);
        if !matches!(motor.drive, Drive::Brushed | Drive::Stepper(_)) {
            return None;
        }
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
    });
    invalid.collect()
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
