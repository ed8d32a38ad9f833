//! Values of a robot file that are valid alone and inconsistent with others or with the
//! controller's bounds. They are refused with the line and key of the file.

use fivebar_files::robot::{BUILT_IN, BuiltIn, Robot};
use fivebar_firmware::settings::SettingsError;

/// The default arm's file with all keys that have defaults.
fn whole() -> String {
    let mut text = BUILT_IN[0].text.to_owned();
    for (section, keys) in [
        ("[limits]", "max_torque = [0.7, 0.7]"),
        (
            "[supply]",
            "range = [16.8, 31.2]\nvoltage_per_code = 0.0117",
        ),
        (
            "[protection]",
            "over_speed = 1.5\nover_current = 1.5\ncommand_timeout = 0.1",
        ),
        ("[[actuator]]", "current_per_code = 0.004"),
    ] {
        text = text.replace(section, &format!("{section}\n{keys}"));
    }
    text + "\n[control]\ntick_rate = 10000.0\nbandwidth = 250.0\ndamping = 1.0\n\
            integral_rate = 60.0\nobserver_bandwidth = 1500.0\ncurrent_bandwidth = 3000.0\n"
}

fn refusal(text: &str) -> String {
    Robot::parse("arm.toml", text)
        .expect_err("an invalid file is refused")
        .to_string()
}

#[test]
fn values_that_the_controller_would_refuse_are_refused_with_line_key_and_bound() {
    let text = whole();
    assert!(Robot::parse("arm.toml", &text).is_ok());
    for (key, odd, words) in [
        ("tick_rate", "99.0", ["100 to 50000 Hz", "not 99.0 Hz"]),
        (
            "tick_rate",
            "60000.0",
            ["100 to 50000 Hz", "not 60000.0 Hz"],
        ),
        (
            "current_bandwidth",
            "3600.0",
            ["`tick_rate`, 3500 rad/s", "3600.0"],
        ),
        (
            "bandwidth",
            "800.0",
            ["`current_bandwidth`, 750 rad/s", "800.0"],
        ),
        ("damping", "0.1", ["0.2 to 2", "not 0.1"]),
        ("integral_rate", "63.0", ["`bandwidth`, 62.5 rad/s", "63.0"]),
        (
            "observer_bandwidth",
            "499.0",
            ["500 to 10000 rad/s", "499.0"],
        ),
        ("singularity_margin", "0.0", ["more than 0", "not 0.0"]),
        ("following_error", "1.0", ["less than 1 rad", "not 1.0 rad"]),
        ("over_speed", "0.9", ["`max_speed` of [limits]", "not 0.9"]),
        ("over_current", "0.9", ["`peak_current`", "not 0.9"]),
        ("command_timeout", "9e-5", ["0.002 to 60 s", "not 9e-5 s"]),
        ("command_timeout", "61.0", ["0.002 to 60 s", "not 61.0 s"]),
        (
            "encoder_counts",
            "600000",
            ["524288 with this gear", "600000"],
        ),
        (
            "continuous_current",
            "4.1",
            ["`peak_current`, 4 A", "4.1 A"],
        ),
        ("current_per_code", "1.8e-3", ["2.742e-3 A", "not 0.0018 A"]),
        ("inductance", "0.24e-7", ["1e-6 to 1 s", "not 1.043e-8 s"]),
        ("inductance", "2.4", ["1e-6 to 1 s", "not 1.043e0 s"]),
        ("range", "[-5.0, 30.0]", ["above 0 V", "not -5.0 V"]),
        ("voltage", "12.0", ["`range`, 16.8 to 31.2 V", "12.0 V"]),
        (
            "voltage_per_code",
            "0.0076",
            ["31.2 V", "7.619e-3 to 1.440e0 V"],
        ),
        (
            "voltage_per_code",
            "1.5",
            ["31.2 V", "7.619e-3 to 1.440e0 V"],
        ),
        ("torque_constant", "1e-40", ["1e-30 to 1e30", "not 1e-40"]),
        ("gear_ratio", "-1e40", ["1e-30 to 1e30", "not -1e40"]),
    ] {
        let assignment = format!("{key} = ");
        let line = text.lines().position(|line| line.starts_with(&assignment));
        let line = line.unwrap_or_else(|| panic!("no {key}"));
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        lines[line] = format!("{assignment}{odd}");
        let message = refusal(&lines.join("\n"));
        let place = format!("arm.toml, line {}: `{key}` of [", line + 1);
        assert!(message.starts_with(&place), "{message}");
        for word in words {
            assert!(message.contains(word), "`{word}` is missing in: {message}");
        }
    }
}

#[test]
fn a_default_that_does_not_fit_is_named_with_its_value() {
    let text = BUILT_IN[0].text;
    let message = refusal(&text.replace("[supply]", "[supply]\nrange = [16.8, 60.0]"));
    for word in ["`voltage_per_code` of [supply]", "60 V", "the default"] {
        assert!(message.contains(word), "`{word}` is missing in: {message}");
    }
}

#[test]
fn a_torque_limit_below_the_continuous_torque_is_accepted() {
    let text = BUILT_IN[0]
        .text
        .replace("[limits]", "[limits]\nmax_torque = [0.1, 0.2]");
    let settings = Robot::parse("arm.toml", &text).unwrap().settings().unwrap();
    for (axis, torque) in settings.axes.iter().zip([0.1, 0.2]) {
        let current = torque / (0.0234 * 8.0);
        assert!((axis.peak_current - current).abs() < 1e-6);
        assert_eq!(axis.continuous_current, axis.peak_current);
    }
    assert_eq!(settings.check().err(), None);
}

/// Each number of the file is multiplied by powers of ten. The controller accepts every file that
/// the reader accepts, except arms without a pose.
#[test]
fn the_controller_accepts_every_file_that_the_reader_accepts() {
    let text = whole();
    let mut taken = 0;
    let mut refused = 0;
    for (number, line) in text.lines().enumerate() {
        let Some((key, value)) = line.split_once(" = ") else {
            continue;
        };
        for exponent in (-9..=9).chain([-50, 50]) {
            let Some(odd) = scaled(value, 10_f64.powi(exponent)) else {
                continue;
            };
            let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
            lines[number] = format!("{key} = {odd}");
            match Robot::parse("arm.toml", &lines.join("\n")) {
                Err(error) => {
                    refused += 1;
                    // Every error has a line, also for an integer that becomes a fraction.
                    assert!(error.line.is_some(), "{error}");
                }
                Ok(robot) => {
                    taken += 1;
                    let verdict = robot.settings().unwrap().check();
                    let no_pose = verdict.err() == Some(SettingsError::NoPose);
                    assert!(verdict.is_ok() || no_pose, "{key} = {odd}: {verdict:?}");
                }
            }
        }
    }
    assert!(
        taken > 300 && refused > 300,
        "{taken} taken, {refused} refused"
    );
}

/// A number or a list of numbers times `factor`; none for other values.
fn scaled(value: &str, factor: f64) -> Option<String> {
    let value: toml::Table = toml::from_str(&format!("value = {value}")).ok()?;
    fn times(value: &toml::Value, factor: f64) -> Option<toml::Value> {
        Some(match value {
            toml::Value::Float(number) => toml::Value::Float(number * factor),
            toml::Value::Integer(number) => {
                let scaled = *number as f64 * factor;
                toml::Value::Integer(if scaled < 9e18 {
                    scaled as i64
                } else {
                    i64::MAX
                })
            }
            toml::Value::Array(items) => {
                let items = items.iter().map(|item| times(item, factor));
                toml::Value::Array(items.collect::<Option<_>>()?)
            }
            _ => return None,
        })
    }
    times(value.get("value")?, factor).map(|value| value.to_string())
}

/// Without one, the rest of the program counts a torque of 1 N·m as a current of 1 A, and nobody takes that for the motor's.
#[test]
fn a_drives_torque_constant_is_stated_also_if_it_is_1() {
    let leg = BuiltIn::find("leg").expect("a robot").text;
    for (line, stated) in [
        ("torque_constant = 0.0243\n", Some(0.0243)),
        ("torque_constant = 1.0\n", Some(1.0)),
        ("", None),
    ] {
        let text = leg
            .replace("torque_constant = 0.0243\n", line)
            .replace("max_speed = 600.0", "max_speed = 100.0");
        let robot = Robot::parse("leg.toml", &text).expect("a robot");
        for actuator in robot.actuators.expect("drives") {
            assert_eq!(actuator.stated_torque_constant(), stated);
            assert_eq!(actuator.torque_constant, stated.unwrap_or(1.0));
        }
    }
}

#[test]
fn a_torque_constant_in_another_unit_is_refused_with_the_value_that_is_meant() {
    for (wrong, meant) in [("23.4", "0.0234"), ("0.0000234", "0.0234")] {
        let text = BUILT_IN[0].text.replace(
            "torque_constant = 0.0234",
            &format!("torque_constant = {wrong}"),
        );
        let message = refusal(&text);
        for word in [
            "`torque_constant` of [[actuator]] 1",
            &format!("({meant} N·m/A meant?)"),
        ] {
            assert!(message.contains(word), "`{word}` is missing in: {message}");
        }
    }
}

#[test]
fn values_too_small_to_be_meant_in_their_unit_are_refused_with_the_least() {
    let text = BUILT_IN[0].text;
    for (section, key, small, words) in [
        (
            "[[link]]",
            "mass",
            "1e-12",
            "must be at least 1e-6 kg, not 1e-12",
        ),
        (
            "[[link]]",
            "inertia",
            "1e-20",
            "must be at least 1e-13 kg·m², not 1e-20",
        ),
        (
            "[limits]",
            "max_speed",
            "[35.0, 1e-9]",
            "must be at least 1e-4 rad/s, not 1e-9",
        ),
        (
            "[limits]",
            "max_acceleration",
            "[1e-9, 9.0]",
            "must be at least 1e-4 rad/s², not 1e-9",
        ),
        (
            "[motion]",
            "max_speed",
            "1e-5",
            "must be at least 1e-4 m/s, not 1e-5",
        ),
        (
            "[motion]",
            "max_acceleration",
            "1e-10",
            "must be at least 1e-4 m/s², not 1e-10",
        ),
        (
            "[motion]",
            "max_jerk",
            "9e-5",
            "must be at least 1e-4 m/s³, not 9e-5",
        ),
    ] {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let start = lines.iter().position(|line| line == section).unwrap();
        let assignment = format!("{key} = ");
        let index = lines[start..]
            .iter()
            .position(|line| line.starts_with(&assignment));
        let line = start + index.unwrap_or_else(|| panic!("no {key} in {section}"));
        lines[line] = format!("{assignment}{small}");
        let message = refusal(&lines.join("\n"));
        let place = format!("arm.toml, line {}: `{key}` of [", line + 1);
        assert!(message.starts_with(&place), "{message}");
        assert!(
            message.contains(words),
            "`{words}` is missing in: {message}"
        );
    }
}

#[test]
fn a_file_without_end_and_one_of_too_many_keys_are_refused_by_their_size() {
    if cfg!(unix) {
        let message = Robot::load("/dev/zero").unwrap_err().to_string();
        assert_eq!(
            message,
            "/dev/zero: at most 1048576 bytes are read, and it goes on after that"
        );
    }
    let keys: String = (0..200_000).map(|key| format!("k{key} = 1\n")).collect();
    let message = refusal(&keys);
    let size = format!("it has {} bytes; at most 1048576 are read", keys.len());
    assert!(message.ends_with(&size), "{message}");
}
