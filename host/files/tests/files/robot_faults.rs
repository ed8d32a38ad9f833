//! A robot file with several faults is answered with all of them, each with its line and key.

use fivebar_files::robot::{BUILT_IN, Robot};

/// The default arm with these lines in place of others, or in addition at the top of a section.
fn changed(changes: &[(&str, &str)]) -> String {
    let mut text = BUILT_IN[0].text.to_owned();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replacen(old, new, 1);
    }
    text
}

/// The refusals of a file, one a line.
pub(crate) fn refusals(text: &str) -> Vec<String> {
    let error = Robot::parse("arm.toml", text).expect_err("an invalid file is refused");
    error.to_string().lines().map(str::to_owned).collect()
}

/// Asserts that each of these is refused, in its line, and nothing else is.
#[track_caller]
fn assert_refused(text: &str, expected: &[(&str, &str)]) {
    let refusals = refusals(text);
    for (assignment, sentence) in expected {
        let line = text.lines().position(|line| line.starts_with(assignment));
        let line = 1 + line.unwrap_or_else(|| panic!("no {assignment}"));
        let wanted = format!("arm.toml, line {line}: {sentence}");
        let found = refusals.iter().any(|refusal| refusal.starts_with(&wanted));
        assert!(found, "{wanted} is not in {refusals:#?}");
    }
    assert_eq!(refusals.len(), expected.len(), "{refusals:#?}");
}

#[test]
fn three_faults_that_the_controller_finds_get_three_answers() {
    let text = changed(&[(
        "resistance = 2.3",
        "resistance = 2.3\nthermal_time_constant_ = 1",
    )]);
    // An unknown key ends the reading at once.
    assert_eq!(refusals(&text).len(), 1);
    let text = changed(&[])
        + "\n[control]\ntick_rate = 99.0\ndamping = 0.1\nbandwidth = 200.0\n\
                               integral_rate = 60.0\ncurrent_bandwidth = 3000.0\n";
    assert_refused(
        &text,
        &[
            (
                "tick_rate = ",
                "`tick_rate` of [control] must lie in 100 to 50000 Hz, not 99.0 Hz",
            ),
            (
                "damping = ",
                "`damping` of [control] must lie in 0.2 to 2, not 0.1",
            ),
            (
                "integral_rate = ",
                "`integral_rate` of [control] must lie between 0 and a quarter of `bandwidth`, \
                 50 rad/s, not 60.0 rad/s",
            ),
        ],
    );
}

#[test]
fn faults_of_all_kinds_are_answered_together() {
    let text = changed(&[
        ("payload = 0.03", "payload = -0.03"),
        ("mass = 0.05", "mass = -1.0"),
        ("resistance = 2.3", "resistance = nan"),
    ]) + "\n[tool_output]\nkind = \"power\"\nfrequency = 1.0\n";
    assert_refused(
        &text,
        &[
            ("payload = ", "`payload` must be finite and not negative"),
            ("mass = -1.0", "`mass` of [[link]] 2 must be a positive"),
            ("resistance = nan", "`resistance` of [[actuator]] 1 must be"),
            ("frequency = ", "`frequency` of [tool_output] must be 10.0"),
        ],
    );
}

#[test]
fn values_that_are_not_plausible_and_those_of_the_controller_are_answered_together() {
    let text = changed(&[
        ("mass = 0.05", "mass = 50.0"),
        ("inductance = 0.24e-3", "inductance = 0.24"),
    ]) + "\n[control]\ndamping = 3.0\nbandwidth = 200.0\nintegral_rate = 20.0\n\
          observer_bandwidth = 1500.0\ncurrent_bandwidth = 3000.0\n";
    assert_refused(
        &text,
        &[
            ("mass = 50.0", "`mass` of [[link]] 2 must be"),
            (
                "inductance = 0.24",
                "`inductance` of [[actuator]] 1 must be",
            ),
            ("damping = ", "`damping` of [control] must lie in 0.2 to 2"),
        ],
    );
}

#[test]
fn the_friction_of_a_pen_is_fed_forward_by_drives_that_take_a_torque() {
    let with = |name: &str, force: &str| {
        let text = fivebar_files::robot::BuiltIn::find(name).unwrap().text;
        format!("{text}\n[advanced]\npen_friction = {force}\n")
    };
    for name in ["benchtop", "benchtop_belt", "leg"] {
        let robot = Robot::parse("arm.toml", &with(name, "0.25")).unwrap();
        assert_eq!(robot.settings().unwrap().advanced.pen_friction, 0.25);
    }
    for name in ["benchtop_stepper", "classroom_servo"] {
        assert_refused(
            &with(name, "0.25"),
            &[(
                "pen_friction = ",
                "`pen_friction` of [advanced] is for drives that take a torque",
            )],
        );
        assert!(Robot::parse("arm.toml", &with(name, "0.0")).is_ok());
    }
}

#[test]
fn a_number_of_the_controller_is_read_and_refused_with_its_line() {
    let with = |value: &str| changed(&[]) + "\n[advanced]\ndisarm_timeout = " + value + "\n";
    let timeout = |text: &str| {
        let robot = Robot::parse("arm.toml", text).unwrap();
        robot.settings().unwrap().advanced.disarm_timeout
    };
    assert_eq!(timeout(&changed(&[])), 60.0);
    assert_eq!(timeout(&with("2.5")), 2.5);
    assert_refused(
        &with("0.1"),
        &[(
            "disarm_timeout = ",
            "`disarm_timeout` of [advanced] must lie in 1 to 86 400 s, not 0.1 s",
        )],
    );
    let unknown = refusals(&with("2.0\ndisarm_time = 1.0"));
    assert!(
        unknown[0].contains("did you mean `disarm_timeout`?"),
        "{unknown:?}"
    );
}

/// The built-in robot with steppers, with this line of the first `[[actuator]]` changed.
fn stepper(old: &str, new: &str) -> String {
    let text = fivebar_files::robot::BuiltIn::find("benchtop_stepper")
        .expect("built in")
        .text;
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

#[test]
fn steppers_are_refused_what_they_cannot_do_with_the_way_out() {
    for (old, new, sentence) in [
        (
            "microsteps = 16",
            "microsteps = 16\nencoder_counts = 400",
            "must be 1600 per motor turn at least",
        ),
        (
            "microsteps = 16",
            "microsteps = 16\nencoder_side = \"joint\"",
            "needs `encoder_counts`",
        ),
        (
            "kind = \"stepper\"\n",
            "",
            "is missing: a drive of kind \"brushed\" needs it",
        ),
        ("microsteps = 16", "microsteps = 0", "must be 1 to 256"),
        (
            "steps_per_turn = 200",
            "steps_per_turn = 201",
            "multiple of 4",
        ),
        (
            "microsteps = 16",
            "microsteps = 256",
            "a driver takes 200000",
        ),
        (
            "holding_torque = 0.40",
            "holding_torque = -0.40",
            "`holding_torque` of [[actuator]] 1 must be",
        ),
        (
            "torque_share = 0.6",
            "torque_share = 6.0",
            "must be 0.05 to 2",
        ),
        (
            "gravity = [0.0, 0.0]",
            "gravity = [0.0, -9.81]",
            "nothing shows whether the brakes hold it",
        ),
        (
            "rated_current = 1.7",
            "rated_current = 17.0",
            "V over `resistance`",
        ),
        ("voltage = 24.0", "voltage = 3.0", "is too fast"),
        (
            "kind = \"stepper\"",
            "kind = \"steper\"",
            "unknown variant `steper`",
        ),
    ] {
        let refusals = refusals(&stepper(old, new));
        let found = refusals
            .iter()
            .any(|refusal| refusal.contains(sentence) && refusal.starts_with("arm.toml, line "));
        assert!(found, "{new}: {sentence} is not in {refusals:#?}");
    }
}

#[test]
fn encoders_on_steppers_need_room_for_the_swing_when_the_current_comes() {
    let both = |following_error: &str| {
        let text = stepper("following_error = 0.05", following_error);
        text.replace("microsteps = 16", "microsteps = 16\nencoder_counts = 4000")
    };
    Robot::parse("arm.toml", &both("following_error = 0.05")).expect("with encoders");
    let refused = Robot::parse("arm.toml", &both("following_error = 0.02")).unwrap_err();
    let sentence = "must be 0.039 rad at least, 5 full steps of joint 1";
    assert!(refused.to_string().contains(sentence), "{refused}");
    // Without power its place stays known while it falls.
    let falls =
        both("following_error = 0.05").replace("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]");
    Robot::parse("arm.toml", &falls).expect("with encoders it may fall");
}

/// The built-in robot with hobby servos, with this text of its file changed in one place.
fn plotter(old: &str, new: &str) -> String {
    let text = fivebar_files::robot::BuiltIn::find("classroom_servo")
        .expect("built in")
        .text;
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn hobby_servos_are_refused_what_they_cannot_do_with_the_way_out() {
    for (old, new, sentence) in [
        (
            "travel = 3.1415927",
            "travel = 2.0",
            "`travel` of [[actuator]] 1 turns joint 1 from 1.130 to 3.130 rad, and its `angle` of [limits] is [0.63, 3.63] \
             rad: narrow that, or set `middle_angle`",
        ),
        (
            "travel = 3.1415927",
            "travel = 3.1415927\nmiddle_angle = 1.5",
            "turns joint 1 from -0.071 to 3.071 rad",
        ),
        (
            "travel = 3.1415927",
            "travel = 3.1415927\ngear_ratio = -2.0",
            "turns joint 1 from 1.345 to 2.915 rad",
        ),
        (
            "travel = 3.1415927",
            "travel = 180.0",
            "must be 0.5 to 7.0 rad",
        ),
        (
            "travel = 3.1415927\n",
            "",
            "`travel` of [[actuator]] 1 is missing: a drive of kind \"servo\" needs it",
        ),
        (
            "pulse_range = [0.0005, 0.0025]\n",
            "",
            "`pulse_range` of [[actuator]] 1 is missing",
        ),
        (
            "[0.0005, 0.0025]",
            "[0.0025, 0.0005]",
            "has a negative `gear_ratio`",
        ),
        (
            "[0.0005, 0.0025]",
            "[500.0, 2500.0]",
            "must be two widths from 0.0003 to 0.0027 s",
        ),
        (
            "frame_rate = 50.0",
            "frame_rate = 400.0",
            "must be 50.0 to 333.0 Hz, not 400.0",
        ),
        (
            "frame_rate = 50.0",
            "frame_rate = 20.0",
            "every servo takes 50 Hz",
        ),
        (
            "dead_band = 5e-6",
            "dead_band = 5.0",
            "`dead_band` of [[actuator]] 1 must be",
        ),
        (
            "stall_torque = 0.177",
            "stall_torque = -0.177",
            "`stall_torque` of [[actuator]] 1 must be",
        ),
        (
            "max_speed = [3.0, 3.0]",
            "max_speed = [3.0, 9.0]",
            "of joint 4 is 9.0 rad/s, and motions may take 0.8 of what its servo can, so that the servo can catch up: \
             lower it to 8.400 rad/s",
        ),
        ("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]", ""),
        (
            "gravity = [0.0, 0.0]\nbase = 0.05\n# A felt pen in a clothes peg, with the servo that lifts it, at C.\npayload = 0.02",
            "gravity = [0.0, -9.81]\nbase = 0.05\npayload = 0.2",
            "cannot hold joint 1 against gravity: in some pose it needs",
        ),
        (
            "kind = \"servo\"\npulse_range",
            "kind = \"servo\"\nencoder_counts = 400\npulse_range",
            "is a key of kind \"brushed\" or \"stepper\" or \"can-torque\", and this drive is of kind \"servo\"",
        ),
        (
            "[supply]",
            "[homing]\nmethod = \"switch\"\n[supply]",
            "a hobby servo knows its own: leave it out",
        ),
        (
            "[supply]",
            "[homing]\nspeed = 0.1\n[supply]",
            "is of a search, and this method moves nothing",
        ),
        (
            "[supply]",
            "[crossing]\nallowed = true\n[supply]",
            "with hobby servos leave it out",
        ),
        (
            "frame_rate = 50.0",
            "frame_rate = 50.0\ntorque_share = 5.0",
            "must be 0.05 to 2.0 of the torque",
        ),
    ] {
        let text = plotter(old, new);
        if sentence.is_empty() {
            Robot::parse("arm.toml", &text).expect("these servos hold this arm upright");
            continue;
        }
        let refusals = refusals(&text);
        let found = refusals
            .iter()
            .any(|refusal| refusal.contains(sentence) && refusal.starts_with("arm.toml, line "));
        assert!(found, "{new}: {sentence} is not in {refusals:#?}");
    }
    // Both joints have servos, or none has.
    let text = plotter(
        "kind = \"servo\"\npulse_range",
        "kind = \"servo\"\npulse_range",
    );
    let stepper = stepper("name = ", "name = ");
    let (first, second) = (
        text.find("[[actuator]]").unwrap(),
        text.rfind("[[actuator]]").unwrap(),
    );
    let of_stepper =
        &stepper[stepper.find("[[actuator]]").unwrap()..stepper.rfind("[[actuator]]").unwrap()];
    let mixed = format!("{}{of_stepper}{}", &text[..first], &text[second..]);
    let refusals = refusals(&mixed);
    assert!(
        refusals[0].contains("`kind` of [[actuator]] 2 must be the same"),
        "{refusals:#?}"
    );
}

/// A motion takes half of the torque that a servo has at its joint's greatest speed, by the controller's own limits.
#[test]
fn the_controller_plans_with_a_share_of_the_torque_that_a_servo_has_at_speed() {
    for (share, speed) in [(0.5, 3.0), (0.3, 6.0)] {
        let text = plotter(
            "max_speed = [3.0, 3.0]",
            &format!("max_speed = [2.0, {speed:?}]"),
        );
        let text = text.replace(
            "travel = 3",
            &format!("torque_share = {share:?}\ntravel = 3"),
        );
        let robot = Robot::parse("arm.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        let settings = robot.settings().unwrap();
        let usual = Robot::parse("arm.toml", BUILT_IN[0].text).unwrap();
        let usual = usual.settings().unwrap().advanced.motion_torque;
        let at_speed = 1.0 - speed / 10.5;
        assert!((settings.advanced.motion_torque / usual - at_speed as f32).abs() < 1e-6);
        for axis in &settings.axes {
            let torque = f64::from(axis.peak_current * axis.torque_constant);
            assert!((torque - share * 0.177).abs() < 1e-6, "{torque}");
        }
    }
}

/// The simulated servo is at the width that its robot file means, whichever way it turns.
#[test]
fn the_width_at_home_follows_from_the_angle_at_the_middle_of_the_widths() {
    let home = 2.617_993_9_f64;
    for (keys, middle, gear_ratio) in [
        ("", 0.5 * (0.63 + 3.63), 1.0),
        ("\nmiddle_angle = 2.2", 2.2, 1.0),
        ("\nmiddle_angle = 2.2\ngear_ratio = -1.0", 2.2, -1.0),
    ] {
        let text = plotter("travel = 3.1415927", &format!("travel = 3.2{keys}"));
        let robot = Robot::parse("arm.toml", &text).unwrap_or_else(|error| panic!("{error}"));
        let [servo, _] = robot.hobby_servos().unwrap();
        let expected = 1.5e-3 + gear_ratio * (home - middle) * 2e-3 / 3.2;
        assert!((servo.home_width - expected).abs() < 1e-9, "{servo:?}");
        // 20 ms of a typical small motor.
        assert!((servo.rotor_inertia - 0.02 * 0.177 / 10.5).abs() < 1e-12);
        let [first, _] = robot.actuators.unwrap();
        assert_eq!(
            first.encoder_counts,
            (std::f64::consts::TAU / 3.2 * 4000.0).round() as u32
        );
    }
}
