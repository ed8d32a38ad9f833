//! Whether a robot's values fit together, and whether its controller takes them: told by
//! the file's own keys, not by the settings that are made of them.

use super::Robot;
use super::settings::ADC_CODES;
use crate::input::source::{FileError, Key, Source};
use fivebar_firmware::settings::{AxisField, Field, SettingsError};

/// Least and greatest time constant of a winding [s]; real ones have 20 µs to 50 ms. Beyond,
/// the current loop has no digits left.
const WINDING: [f64; 2] = [1e-6, 1.0];

/// A value as a person would write it, its unit and what it must be instead.
type Misfit = (Key, String, &'static str, String);

/// Looks at values that make sense each for itself.
pub(super) fn check(source: &Source<'_>, robot: &Robot) -> Result<(), FileError> {
    let misfit = motors(robot).or_else(|| bus(robot));
    if let Some(misfit) = misfit {
        return Err(refusal(source, misfit));
    }
    // An arm known by its lengths alone has no controller.
    let Ok(settings) = robot.settings() else {
        return Ok(());
    };
    match settings.validate() {
        // What has no pose to control can still be analysed.
        Ok(())
        | Err(SettingsError::Geometry(_) | SettingsError::Inertia(_) | SettingsError::NoPose) => {
            Ok(())
        }
        Err(error) => Err(match setting(robot, error) {
            Some(misfit) => refusal(source, misfit),
            None => FileError {
                file: source.file.into(),
                line: None,
                reason: format!("the controller refuses it: {error}"),
            },
        }),
    }
}

/// Why the controller refuses a robot whose file makes sense.
pub(crate) fn in_words_of_its_file(error: SettingsError) -> String {
    match error {
        SettingsError::NoPose => {
            "it has no pose to control: over the `angle` of [limits], none with \
             its elbows as `working_mode` says keeps the `singularity_margin` of [limits]"
                .into()
        }
        other => other.to_string(),
    }
}

fn refusal(source: &Source<'_>, (key, value, unit, must): Misfit) -> FileError {
    let space = if unit.is_empty() { "" } else { " " };
    let default = if source.holds(key) {
        ""
    } else {
        ", as it is when left out"
    };
    source.refuse(key, format!("{must}, not {value}{space}{unit}{default}"))
}

fn written(value: f64) -> String {
    format!("{value:?}")
}

fn motors(robot: &Robot) -> Option<Misfit> {
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
        // Zero lies in the middle of the codes.
        let needed = robot.limited(index, *motor).peak_current / (0.5 * ADC_CODES - 1.0);
        let per_code = motor.current_per_code.filter(|&amperes| amperes < needed)?;
        let must = format!("must be at least {needed:.3e} A for 12 bits to hold the peak current");
        Some((key("current_per_code"), written(per_code), "A", must))
    })
}

/// The bus must read as sound while it is, and as too high once it is.
fn bus(robot: &Robot) -> Option<Misfit> {
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
        "must be {least:.3e} to {greatest:.3e} V for 12 bits to tell when the bus leaves {low} to \
         {high} V"
    );
    let key = Key::In("supply", "voltage_per_code");
    Some((key, written(per_code), "V", must))
}

/// What the controller refuses, as the file has it; none for what the reader of the file
/// lets through in no robot that could be built.
fn setting(robot: &Robot, error: SettingsError) -> Option<Misfit> {
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
                "times `gear_ratio` must be at most 4194304 a turn of the joint, what single \
                 precision tells apart: {:.0} at this gear",
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
