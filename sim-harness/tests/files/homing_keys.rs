//! The keys of `[homing]`: what the controller makes of them, and what is refused.

use fivebar::input::robot::Robot;
use fivebar_firmware::Settings;

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
        ("method = 1", ["method", "unknown"]),
    ] {
        let text = format!("{BENCHTOP}\n[homing]\n{keys}\n");
        let message = Robot::parse("arm.toml", &text).unwrap_err().to_string();
        assert!(message.contains(&line.to_string()), "{keys}: {message}");
        for word in words {
            assert!(message.contains(word), "{keys}: {message}");
        }
    }
}
