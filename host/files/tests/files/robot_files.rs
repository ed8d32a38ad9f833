//! Robot files: which are accepted, and how others are refused.

use fivebar_files::robot::{BUILT_IN, BuiltIn, Robot};
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::drives::BrushedCommand;
use fivebar_plant::Mismatch;
use fivebar_plant::Plant;

/// A small file with every key that has no default.
const PLAIN: &str = r#"name = "asymmetric"
gravity = [0.0, -9.81]
base = 0.118
payload = 0.15
[[link]]
length = 0.09
mass = 0.12
com = [0.04, 0.003]
inertia = 1.2e-4
[[link]]
length = 0.16
mass = 0.1
com = [0.07, 0.0]
inertia = 3e-4
[[link]]
length = 0.15
mass = 0.1
com = [0.06, -0.002]
inertia = 2e-4
[[link]]
length = 0.1
mass = 0.12
com = [0.05, 0.0]
inertia = 1.2e-4
"#;

#[track_caller]
fn assert_refused(text: &str, line: usize, words: &[&str]) {
    let error = Robot::parse("arm.toml", text).expect_err("an invalid file is refused");
    let message = error.to_string();
    assert!(
        message.starts_with(&format!("arm.toml, line {line}: ")),
        "{message}"
    );
    for word in words {
        assert!(message.contains(word), "`{word}` is missing in: {message}");
    }
}

#[test]
fn every_built_in_robot_is_read_under_its_name() {
    assert_eq!(BUILT_IN[0].name, BuiltIn::DEFAULT);
    for built_in in BUILT_IN {
        let robot = built_in.robot().unwrap();
        assert_eq!(robot.name, built_in.name);
        assert!(!built_in.summary().is_empty());
    }
}

#[test]
fn a_file_without_optional_sections_has_ideal_torque_sources() {
    let robot = Robot::parse("arm.toml", PLAIN).unwrap();
    let arm = robot.arm().unwrap();
    assert_eq!(arm.payload(), 0.15);
    assert_eq!(arm.links()[2].com.y, -0.002);
    assert_eq!(arm.rotor_inertia(), [0.0; 2]);
    let settings = robot.settings().unwrap();
    assert_eq!(settings.lengths, [0.09, 0.16, 0.15, 0.1, 0.118]);
    assert_eq!(settings.axes[0].coulomb_friction, 0.0);
    // Gravity torque of the whole mass at full reach is well within the ideal drive's.
    let axis = &settings.axes[0];
    assert!(axis.peak_current * axis.torque_constant > 2.0 * 9.81 * 0.59 * 0.25);
}

#[test]
fn a_robot_with_masses_must_state_its_payload() {
    let error = Robot::parse("arm.toml", &PLAIN.replace("payload = 0.15\n", "")).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("`payload` is missing"), "{message}");
    assert!(!BuiltIn::find("duet").unwrap().text.contains("payload"));
}

#[test]
fn missing_keys_are_refused_by_name() {
    for key in ["name", "gravity", "base"] {
        let text: String = PLAIN
            .lines()
            .filter(|line| !line.starts_with(&format!("{key} =")))
            .map(|line| format!("{line}\n"))
            .collect();
        assert_refused(&text, 1, &[&format!("missing field `{key}`")]);
    }
    assert_refused(
        &PLAIN.replacen("length = 0.16\n", "", 1),
        10,
        &["missing field `length`"],
    );
    let cases = [("mass = 0.12\n", "mass"), ("com = [0.04, 0.003]\n", "com")];
    for (line, key) in cases.into_iter().chain([("inertia = 1.2e-4\n", "inertia")]) {
        assert_refused(
            &PLAIN.replacen(line, "", 1),
            5,
            &[key, "[[link]] 1", "missing"],
        );
    }
}

#[test]
fn a_name_is_one_line() {
    for name in ["two\\nlines", "a bell \\u0007"] {
        let text = PLAIN.replacen("name = \"", &format!("name = \"{name} "), 1);
        assert_refused(&text, 1, &["`name` must be one line"]);
    }
}

#[test]
fn unknown_keys_are_refused_by_name() {
    let top = PLAIN.replace("payload =", "paylod =");
    assert_refused(&top, 4, &["unknown field `paylod`"]);
    let link = PLAIN.replacen("mass =", "weight =", 1);
    assert_refused(&link, 7, &["unknown field `weight`"]);
    let section = format!("{PLAIN}[motion]\nmax_sped = 1.0\n");
    assert_refused(&section, 26, &["unknown field `max_sped`"]);
    let table = format!("{PLAIN}[montion]\nmax_speed = 1.0\n");
    assert_refused(&table, 25, &["unknown field `montion`"]);
}

#[test]
fn invalid_numbers_are_refused_with_their_line() {
    for bad in ["-0.09", "0.0", "nan", "inf"] {
        let text = PLAIN.replace("length = 0.09", &format!("length = {bad}"));
        assert_refused(&text, 6, &["`length`", "[[link]] 1", "positive"]);
    }
    for bad in ["-0.12", "0.0", "nan"] {
        let text = PLAIN.replacen("mass = 0.12", &format!("mass = {bad}"), 1);
        assert_refused(&text, 7, &["`mass`", "[[link]] 1", "positive"]);
    }
    let text = PLAIN.replace("inertia = 3e-4", "inertia = -3e-4");
    assert_refused(&text, 14, &["`inertia`", "[[link]] 2"]);
    let text = PLAIN.replace("com = [0.07, 0.0]", "com = [nan, 0.0]");
    assert_refused(&text, 13, &["`com`", "[[link]] 2"]);
    let text = PLAIN.replace("gravity = [0.0, -9.81]", "gravity = [0.0, -inf]");
    assert_refused(&text, 2, &["`gravity`"]);
    assert_refused(
        &PLAIN.replace("base = 0.118", "base = -0.1"),
        3,
        &["`base`"],
    );
    assert_refused(
        &PLAIN.replace("payload = 0.15", "payload = -1"),
        4,
        &["`payload`"],
    );
    assert_refused(
        &PLAIN.replace("base = 0.118", "base = 'wide'"),
        3,
        &["`base`", "invalid type", "expected a number"],
    );
    let text = PLAIN.replacen("mass = 0.1\n", "mass = true\n", 1);
    assert_refused(&text, 12, &["`mass`", "invalid type"]);
    let text = PLAIN.replace("gravity = [0.0, -9.81]", "gravity = -9.81");
    assert_refused(&text, 2, &["`gravity`", "invalid type"]);
    let text = format!("{PLAIN}[limits]\nangle = [[0.0, 'x'], [0.0, 1.0]]\n");
    assert_refused(&text, 26, &["`angle`", "invalid type"]);
    for key in ["max_speed", "max_acceleration", "max_torque"] {
        for pair in ["[nan, 1.0]", "[1.0, nan]", "[-1.0, 1.0]", "[1.0, inf]"] {
            let text = format!("{PLAIN}[limits]\n{key} = {pair}\n");
            assert_refused(&text, 26, &[&format!("`{key}` of [limits]"), "positive"]);
        }
    }
    let text = format!("{PLAIN}[tolerance]\nlength_sd = [1e-5, 1e-5]\n");
    assert_refused(&text, 26, &["`length_sd`", "one number or 5"]);
    let text = format!("{PLAIN}[limits]\nangle = [[1.0, 0.0], [0.0, 1.0]]\n");
    assert_refused(&text, 26, &["`angle`", "[least, greatest]"]);
}

#[test]
fn degrees_and_millimetres_are_refused_with_the_right_unit() {
    let text = format!("{PLAIN}[limits]\nangle = [[0.0, 90.0], [0.0, 1.0]]\n");
    assert_refused(&text, 26, &["`angle`", "radians", "90.0"]);
    let text = PLAIN.replace("base = 0.118", "base = 118");
    assert_refused(&text, 3, &["`base`", "metres", "118.0"]);
    let text = PLAIN.replace("length = 0.09", "length = 90");
    assert_refused(&text, 6, &["`length` of [[link]] 1", "metres", "90.0"]);
    let text = PLAIN.replace("com = [0.04, 0.003]", "com = [40, 3]");
    assert_refused(&text, 8, &["`com` of [[link]] 1", "metres", "40.0"]);
    let text = format!("{PLAIN}[tool]\noffset = [0, -25]\n");
    assert_refused(&text, 26, &["`offset` of [tool]", "metres", "-25.0"]);
}

#[test]
fn an_arm_that_cannot_be_assembled_is_refused_with_its_lengths() {
    let text = PLAIN.replace("base = 0.118", "base = 5.0");
    assert_refused(&text, 3, &["cannot be assembled", "5.0 m"]);
}

#[test]
fn a_gear_may_reverse_but_not_be_zero() {
    let text = BUILT_IN[0].text;
    let geared = |ratio| text.replacen("gear_ratio = 8.0", &format!("gear_ratio = {ratio}"), 1);
    assert!(Robot::parse("arm.toml", &geared("-8.0")).is_ok());
    let first = text.lines().position(|line| line == "gear_ratio = 8.0");
    let line = 1 + first.unwrap();
    for ratio in ["0", "nan"] {
        assert_refused(
            &geared(ratio),
            line,
            &["`gear_ratio`", "must not be 0 (negative"],
        );
    }
}

#[test]
fn a_refused_number_is_printed_as_in_the_file() {
    let text = PLAIN.replace("payload = 0.15", "payload = -1e300");
    assert_refused(&text, 4, &["not -1e300"]);
}

#[test]
fn a_pair_of_three_numbers_is_refused_by_its_key() {
    for (pair, triple, key) in [
        ("[0.04, 0.003]", "[0.04, 0.003, 9.0]", "com"),
        ("[0.0, -9.81]", "[0.0, -9.81, 0.0]", "gravity"),
    ] {
        let error = Robot::parse("arm.toml", &PLAIN.replacen(pair, triple, 1)).unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("length 3") && message.contains(key),
            "{message}"
        );
    }
}

#[test]
fn three_links_or_one_actuator_are_refused() {
    let (three, _) = PLAIN.rsplit_once("[[link]]").unwrap();
    assert_refused(three, 5, &["four times, not 3"]);
    let actuator = BUILT_IN[0].text.split("[[actuator]]").nth(1).unwrap();
    let text = format!("{PLAIN}[[actuator]]\n{actuator}");
    assert_refused(&text, 25, &["given twice, not 1"]);
}

#[test]
fn a_home_without_pose_is_refused() {
    let text = format!("home = [0.0, 0.0]\n{PLAIN}");
    assert_refused(&text, 1, &["`home`", "working mode"]);
}

#[test]
fn a_robot_without_masses_is_refused_where_masses_are_needed() {
    let duet = Robot::load("duet").unwrap();
    let message = duet.settings().unwrap_err().to_string();
    assert!(
        message.contains("duet") && message.contains("lengths only"),
        "{message}"
    );
}

#[test]
fn a_name_that_is_neither_built_in_nor_a_file_lists_the_built_in_ones() {
    let message = Robot::load("nosuch.toml").unwrap_err().to_string();
    assert!(
        message.contains("nosuch.toml") && message.contains("benchtop"),
        "{message}"
    );
}

/// Each number of the default arm's file is replaced by each of several odd values. The file is
/// refused, or its arm runs for a few powered ticks without a panic.
#[test]
fn no_number_in_a_robot_file_makes_the_program_panic_or_hang() {
    const ODD: [&str; 12] = [
        "nan", "inf", "-1", "0", "1e-300", "1e300", "-1e300", "1e-12", "1e12", "'x'", "[]", "true",
    ];
    let text = BUILT_IN[0].text;
    let mut refused = 0;
    for (number, line) in text.lines().enumerate() {
        let Some((key, _)) = line.split_once(" = ") else {
            continue;
        };
        for odd in ODD {
            let mut lines: Vec<_> = text.lines().map(str::to_owned).collect();
            lines[number] = format!("{key} = {odd}");
            let Ok(robot) = Robot::parse("arm.toml", &lines.join("\n")) else {
                refused += 1;
                continue;
            };
            let (Ok(settings), Ok(home)) = (robot.settings(), robot.home_pose()) else {
                refused += 1;
                continue;
            };
            if settings.check().is_err() {
                refused += 1;
                continue;
            }
            let mut plant = Plant::new(
                &robot.plant_parameters().unwrap(),
                &Mismatch::default(),
                &home,
                1,
            );
            for _ in 0..10 {
                plant.sense();
                plant.step(
                    &ActuatorCommand {
                        drives: BrushedCommand { duty: [0.5, -0.5] },
                        enable: [true; 2],
                        brake: false,
                        tool: 0,
                    },
                    1e-4,
                );
            }
        }
    }
    assert!(refused > 200, "only {refused} of the files were refused");
}
