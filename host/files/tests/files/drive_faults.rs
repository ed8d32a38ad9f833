//! What a robot file must not say of drives on a bus and of hobby servos: each refusal with its way out.

use crate::robot_faults::refusals;
use fivebar_files::robot::Robot;

/// The built-in robot with drives on a bus, with this line of the first `[[actuator]]` changed.
fn leg(old: &str, new: &str) -> String {
    let text = fivebar_files::robot::BuiltIn::find("leg")
        .expect("built in")
        .text;
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn drives_on_a_bus_are_refused_what_they_cannot_do_with_the_way_out() {
    let mit =
        "protocol = \"mit\"\nposition_range = 12.5\nvelocity_range = 640.0\ntorque_range = 2.0";
    for (old, new, sentence) in [
        ("node = 1", "node = 2", "is 2, as that of the other drive"),
        ("node = 1", "node = 64", "must be 0 to 63"),
        (
            "node = 1\n",
            "",
            "is missing: a drive of kind \"can-torque\" needs it",
        ),
        (
            "protocol = \"odrive\"\n",
            "",
            "speaks \"odrive\" or \"mit\"",
        ),
        (
            "protocol = \"odrive\"",
            "protocol = \"moteus\"",
            "unknown variant `moteus`",
        ),
        (
            "protocol = \"odrive\"",
            mit,
            "must be the same for both drives",
        ),
        (
            "protocol = \"odrive\"",
            "protocol = \"mit\"",
            "`torque_range` of [[actuator]] 1 is missing",
        ),
        (
            "node = 1",
            "node = 1\ntorque_range = 2.0",
            "is a key of protocol \"mit\"",
        ),
        (
            "node = 1",
            "node = 1\nmicrosteps = 16",
            "is a key of kind \"stepper\", and this drive is of kind \"can-torque\"",
        ),
        (
            "node = 1",
            "node = 1\nstiffness = 2000.0",
            "is a key of kind \"brushed\" or \"stepper\"",
        ),
        (
            "[protection]",
            "[crossing]\nallowed = true\n[protection]",
            "is for brushed motors",
        ),
        (
            "node = 1",
            "node = 1\nresistance = 0.1",
            "is a key of kind \"brushed\" or \"stepper\"",
        ),
        (
            "kind = \"can-torque\"\n",
            "",
            "is a key of kind \"can-torque\", and this drive is of kind \"brushed\"",
        ),
        (
            "peak_torque = 0.97\ncontinuous_torque = 0.39",
            "peak_torque = 0.03\ncontinuous_torque = 0.02",
            "cannot hold joint 1 against gravity",
        ),
        (
            "continuous_torque = 0.39",
            "continuous_torque = 0.03",
            "cannot hold joint 1 against gravity",
        ),
        (
            "continuous_torque = 0.39",
            "continuous_torque = 1.2",
            "must be at most `peak_torque`",
        ),
        (
            "max_speed = 600.0",
            "max_speed = 60.0",
            "needs 90.0 rad/s of the drive",
        ),
        (
            "current_bandwidth = 3000.0",
            "current_bandwidth = 30.0",
            "must be 200 to 4000 rad/s",
        ),
        (
            "current_bandwidth = 3000.0",
            "current_bandwidth = 10000.0",
            "above that the tracking loop rings",
        ),
        (
            "[protection]",
            "[control]\ntick_rate = 2000.0\n[protection]",
            "1000 Hz do",
        ),
        (
            "[protection]",
            "[control]\ntick_rate = 500.0\n[protection]",
            "at least 667 Hz are needed",
        ),
        (
            "[protection]",
            "[homing]\nmethod = \"index\"\n[protection]",
            "the drives tell no index pulse",
        ),
    ] {
        let refusals = refusals(&leg(old, new));
        let found = refusals
            .iter()
            .any(|refusal| refusal.contains(sentence) && refusal.starts_with("arm.toml, line "));
        assert!(found, "{new}: {sentence} is not in {refusals:#?}");
    }
}

#[test]
fn a_hobby_servo_on_the_supply_of_a_motor_is_refused() {
    let text = fivebar_files::robot::BuiltIn::find("classroom_servo")
        .expect("built in")
        .text;
    for volts in ["0.5", "24.0", "60.0"] {
        let refusals = refusals(&text.replace("voltage = 4.8", &format!("voltage = {volts}")));
        let sentence = "the electronics in a hobby servo are rated for 4.8 to 8.4 V";
        assert!(refusals[0].contains(sentence), "{refusals:#?}");
    }
}

#[test]
fn the_ranges_of_mit_type_drives_hold_what_the_arm_needs() {
    let with = |position: f64, velocity: f64, torque: f64| {
        let mit = format!(
            "protocol = \"mit\"\nposition_range = {position:?}\nvelocity_range = {velocity:?}\ntorque_range = {torque:?}"
        );
        let text = fivebar_files::robot::BuiltIn::find("leg")
            .expect("built in")
            .text;
        text.replace("protocol = \"odrive\"", &mit)
    };
    assert!(Robot::parse("arm.toml", &with(12.5, 640.0, 2.0)).is_ok());
    for (text, sentence) in [
        (
            with(1250.0, 640.0, 2.0),
            "1/10 of the `following_error` of [protection] at most; not 1250.0 rad",
        ),
        (
            with(12.5, 64_000.0, 2.0),
            "1/100 of the drive's `max_speed` at most; not 64000.0 rad/s",
        ),
        (
            with(12.5, 640.0, 200.0),
            "1/100 of the drive's `peak_torque` at most; not 200.0 N·m",
        ),
        (
            with(12.5, 640.0, 2.0)
                .replace("current_bandwidth = 3000.0", "current_bandwidth = 300.0"),
            "with a sense: a higher one",
        ),
        (with(3.0, 640.0, 2.0), "of 3.0 rad ends before joint 1 does"),
        (
            with(12.5, 64.0, 2.0),
            "must be at least `max_speed`, 600.0 rad/s",
        ),
        (
            with(12.5, 640.0, 0.5),
            "must be at least `peak_torque`, 0.97 N·m",
        ),
    ] {
        let refusals = refusals(&text);
        assert!(
            refusals.iter().any(|it| it.contains(sentence)),
            "{sentence}: {refusals:#?}"
        );
    }
}
