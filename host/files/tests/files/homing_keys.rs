//! The keys of `[homing]`: what the controller makes of them, and what is refused.

use fivebar_files::robot::Robot;
use fivebar_firmware::Settings;
use fivebar_firmware::settings::{HomeReference, HomingMethod};

const BENCHTOP: &str = include_str!("../../robots/benchtop.toml");

fn settings(keys: &str) -> Settings {
    let text = format!("{BENCHTOP}\n[homing]\n{keys}\n");
    let robot = Robot::parse("arm.toml", &text).unwrap();
    robot.settings().unwrap()
}

#[test]
fn direction_speed_way_and_current_of_the_search_are_the_files() {
    let drawn = settings("");
    let found = settings("forward = [false, true]\nspeed = 0.3\nback_off = 0.08\ncurrent = 0.9");
    assert_eq!(drawn.axes.map(|axis| axis.home_forward), [true, false]);
    assert_eq!(found.axes.map(|axis| axis.home_forward), [false, true]);
    let search = |settings: &Settings| {
        let homing = settings.homing;
        [homing.speed, homing.back_off, homing.current]
    };
    assert_eq!(search(&drawn), [0.7, 0.05, 1.2]);
    assert_eq!(search(&found), [0.3, 0.08, 0.9]);
    found.check().unwrap();
}

#[test]
fn searches_that_the_controller_would_refuse_are_refused_with_line_and_bound() {
    let line = BENCHTOP.lines().count() + 3;
    for (keys, words) in [
        (
            "speed = 36.0",
            ["`speed` of [homing]", "at most 35.0 rad/s"],
        ),
        ("speed = 0.0", ["`speed` of [homing]", "0.0"]),
        (
            "back_off = 1.5",
            ["`back_off` of [homing]", "at most 0.99 rad"],
        ),
        ("back_off = nan", ["`back_off` of [homing]", "NaN"]),
        ("current = 4.5", ["`current` of [homing]", "at most 4.0 A"]),
        ("forward = [1, 2]", ["forward", "boolean"]),
        ("method = 1", ["method", "string"]),
        ("method = \"pulse\"", ["method", "unknown variant"]),
        ("samples = 0", ["`samples` of [homing]", "1 to 255"]),
        ("way = 1", ["way", "unknown"]),
    ] {
        let text = format!("{BENCHTOP}\n[homing]\n{keys}\n");
        let message = Robot::parse("arm.toml", &text).unwrap_err().to_string();
        assert!(message.contains(&line.to_string()), "{keys}: {message}");
        for word in words {
            assert!(message.contains(word), "{keys}: {message}");
        }
    }
}

/// The benchtop arm with `home` 0.03 rad within its limits, where hard stops can be.
fn near_its_limits() -> String {
    let text = BENCHTOP.replace("home = [2.7925268, 0.3490659]", "home = [3.07, 0.06]");
    text.replace(
        "angle = [[0.6, 3.6], [-0.46, 2.54]]",
        "angle = [[0.6, 3.1], [0.03, 2.54]]",
    )
}

/// The same with its encoders at the joints.
fn with_joint_encoders() -> String {
    let counts = "encoder_counts = 16384";
    BENCHTOP.replace(counts, &format!("{counts}\nencoder_side = \"joint\""))
}

#[test]
fn each_method_reaches_the_controller() {
    let given = |text: String, keys: &str| {
        let text = format!("{text}\n[homing]\n{keys}\n");
        let settings = Robot::parse("arm.toml", &text).unwrap().settings().unwrap();
        settings.check().unwrap();
        settings
    };
    let reference = |method, samples| HomeReference { method, samples };
    let switch = given(BENCHTOP.into(), "method = \"switch\"\nsamples = 3");
    assert_eq!(switch.home_reference, reference(HomingMethod::Switch, 3));
    assert_eq!(settings("").home_reference, HomeReference::SWITCHES);
    let stop = given(near_its_limits(), "method = \"hard-stop\"\ncurrent = 0.8");
    // 10 ms at 10 kHz; the stops are the way to back off behind home.
    assert_eq!(stop.home_reference, reference(HomingMethod::HardStop, 100));
    for (axis, angle) in stop.axes.iter().zip([3.12, 0.01]) {
        assert!(
            (axis.home_angle - angle).abs() < 1e-6,
            "{}",
            axis.home_angle
        );
    }
    let index = given(BENCHTOP.into(), "method = \"index\"");
    assert_eq!(index.home_reference, reference(HomingMethod::Index, 8));
    assert_eq!(index.axes.map(|axis| axis.index_counts), [16_384; 2]);
    // The file's home is that of the pulses.
    assert_eq!(index.axes[0].home_angle, switch.axes[0].home_angle);
    let disc_at_joint =
        with_joint_encoders().replace("[[0.6, 3.6], [-0.46, 2.54]]", "[[0.6, 3.6], [-0.46, 3.0]]");
    let keys = "method = \"index\"\nswitch = [3.5, -0.45]\nforward = [true, false]";
    let joint = given(disc_at_joint, keys);
    assert_eq!(joint.axes.map(|axis| axis.index_counts), [131_072; 2]);
    let absolute = given(with_joint_encoders(), "method = \"absolute\"");
    assert_eq!(absolute.home_reference.method, HomingMethod::Absolute);
    let given = given(BENCHTOP.into(), "method = \"given\"");
    assert_eq!(given.home_reference.method, HomingMethod::Given);
}

#[test]
fn a_method_that_does_not_fit_the_arm_is_refused_with_the_key() {
    let stops = "method = \"hard-stop\"\ncurrent = 0.8";
    let near = near_its_limits();
    let wide = with_joint_encoders().replace("[0.6, 3.6]", "[-3.1, 3.6]");
    for (text, keys, words) in [
        (
            BENCHTOP,
            stops,
            "`angle` of [limits] of joint 1 must end before its hard stop",
        ),
        (
            &near,
            "method = \"hard-stop\"",
            "`current` of [homing] must be given",
        ),
        (
            &near,
            "method = \"hard-stop\"\ncurrent = 1.4",
            "1.3 A at most, the least continuous current",
        ),
        (
            &near,
            &format!("{stops}\nsamples = 250"),
            "`speed` of [homing] must be at most 0.400 rad/s",
        ),
        (
            BENCHTOP,
            "method = \"index\"\nspeed = 1.0",
            "`speed` of [homing] must be at most 0.959 rad/s for index pulses",
        ),
        (
            BENCHTOP,
            "method = \"index\"\nswitch = [2.83, 0.0]",
            "`switch` of [homing] of joint 1 closes 0.048 turns of the encoder behind its index pulse",
        ),
        (
            BENCHTOP,
            "method = \"index\"\nswitch = [3.2, -0.4]",
            "`switch` of [homing] of joint 4 closes 0.954 turns of the encoder behind its index pulse",
        ),
        (
            BENCHTOP,
            "method = \"index\"\nswitch = [3.2, 0.5]",
            "of joint 4 closes -0.192 turns of the encoder behind its index pulse",
        ),
        (
            &with_joint_encoders(),
            "method = \"index\"",
            "`switch` of [homing] of joint 1 is at 5.9341 rad, outside limits.angle",
        ),
        (
            BENCHTOP,
            "switch = [3.2, 0.0]",
            "`switch` of [homing] is of the method \"index\"",
        ),
        (
            BENCHTOP,
            "method = \"absolute\"",
            "`encoder_side` of [[actuator]] 1 must be \"joint\"",
        ),
        (
            &wide,
            "method = \"absolute\"",
            "`angle` of [limits] must be a turn at most",
        ),
        (
            BENCHTOP,
            "method = \"given\"\nspeed = 0.2",
            "`speed` of [homing] is of a search",
        ),
        (
            BENCHTOP,
            "method = \"given\"\nsamples = 2",
            "`samples` of [homing] is of a search",
        ),
    ] {
        let text = format!("{text}\n[homing]\n{keys}\n");
        let message = Robot::parse("arm.toml", &text).unwrap_err().to_string();
        assert!(message.contains(words), "{keys}: {message}");
    }
}
