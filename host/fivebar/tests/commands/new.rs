//! The command `fivebar new` and the robot files that it writes.

use fivebar_files::robot::{CanMotor, Draft, Motors, Robot, StepperMotor};
use fivebar_plant::DriverMode;
use proptest::prelude::*;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const PETAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/petal.gcode");

/// Runs `fivebar new arm.toml` in a folder with these lines as answers.
fn new(folder: &Path, arguments: &[&str], answers: &str) -> Output {
    let mut program = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["new", "arm.toml"])
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = program.stdin.take().unwrap();
    // A program without questions may have ended before the write.
    let _ = input.write_all(answers.as_bytes());
    drop(input);
    program.wait_with_output().unwrap()
}

fn message(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn load(folder: &Path) -> Robot {
    Robot::load(folder.join("arm.toml").to_str().unwrap()).unwrap()
}

#[test]
fn the_default_arm_can_be_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &["--defaults"], "");
    assert!(output.status.success(), "{}", message(&output));
    assert_eq!(load(folder.path()).name, "arm");
    let run = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["sim", PETAL, "--robot", "arm.toml", "--json"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", message(&run));
    let figures: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    assert!(
        figures["tip_error"]["rms_m"].as_f64().unwrap() < 5e-5,
        "{figures}"
    );
}

#[test]
fn a_coaxial_arm_keeps_its_links_and_can_be_simulated() {
    let folder = tempfile::tempdir().unwrap();
    // Name, plane, base; the rest are defaults.
    let output = new(folder.path(), &[], &format!("\n\n0\n{}", "\n".repeat(20)));
    assert!(output.status.success(), "{}", message(&output));
    let robot = load(folder.path());
    assert_eq!(robot.geometry.lengths(), [0.1, 0.16, 0.16, 0.1, 0.0]);
    let run = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["sim", PETAL, "--robot", "arm.toml", "--json"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", message(&run));
}

#[test]
fn invalid_answers_are_explained_and_asked_again() {
    let folder = tempfile::tempdir().unwrap();
    let answers = [
        "left hand",
        "sideways",
        "up",
        "-0.1",
        "-1",
        "nan",
        "wide",
        "0.12",
        "0.15, 0.14",
        "0.01",
        "0.25",
        "",
        "",
        "0.1",
        "12",
        "steam",
        "own",
        "0",
        "-20",
        "",
        "",
        "",
        "",
        "4096.5",
        "4096",
        "6",
        "2",
        "",
    ];
    let output = new(folder.path(), &[], &(answers.join("\n") + "\n"));
    let message = message(&output);
    assert!(output.status.success(), "{message}");
    for reason in [
        "\"sideways\" is none of flat, upright",
        "a length must be more than 0 m, not -1",
        "\"wide\" is no valid number",
        "\"nan\" is no valid number",
        "make the couplers longer",
        "\"steam\" is none of",
        "`gear_ratio` of [[actuator]] 1 must be finite and must not be 0",
        "\"4096.5\" is no valid number",
    ] {
        assert!(
            message.contains(reason),
            "`{reason}` is missing in: {message}"
        );
    }
    let robot = load(folder.path());
    assert_eq!(robot.name, "left hand");
    assert_eq!(robot.geometry.lengths(), [0.15, 0.25, 0.25, 0.14, 0.12]);
    let arm = robot.arm().unwrap();
    assert!(arm.gravity().y < -9.8);
    assert_eq!(arm.payload(), 0.1);
    assert_eq!(arm.links()[1].com.x, 0.125);
    assert_eq!(robot.supply.voltage, 12.0);
    let [motor, other] = robot.actuators.unwrap();
    assert_eq!(motor, other);
    assert_eq!((motor.gear_ratio, motor.encoder_counts), (-20.0, 4096));
    assert_eq!((motor.peak_current, motor.continuous_current), (6.0, 2.0));
    // The brake must hold the arm against gravity while unpowered.
    assert!(motor.brake_torque > 0.5, "{}", motor.brake_torque);
}

/// The robot of these lines, and what was said.
fn hanging(answers: &[&str]) -> (Option<Robot>, String) {
    let folder = tempfile::tempdir().unwrap();
    let all = [&["", "up", "", "", "", "", "", "", ""], answers].concat();
    let output = new(folder.path(), &[], &(all.join("\n") + "\n"));
    let robot = output.status.success().then(|| load(folder.path()));
    assert_eq!(robot.is_some(), folder.path().join("arm.toml").exists());
    (robot, message(&output))
}

/// Encoders, and what a servo can, are asked before the arm is refused, and its drives stay of their kind.
#[test]
fn hanging_steppers_and_servos_are_asked_for_what_they_need() {
    let defaults = [""; 9];
    let steppers = [&["stepper"], &defaults[..]].concat();
    let (robot, said) = hanging(&[&steppers[..], &["4000", "0.9"]].concat());
    let robot = robot.expect(&said);
    assert!(robot.has_steppers_with_encoders(), "{said}");
    for drive in robot.actuators.unwrap() {
        assert_eq!((drive.encoder_counts, drive.brake_torque), (4000, 0.9));
    }
    // Without encoders the questions come again.
    let blind = [&steppers[..], &["", ""]].concat();
    let (robot, said) = hanging(&[&blind[..], &defaults, &["4000", ""]].concat());
    assert!(
        said.contains("without encoders") || said.contains("Without encoders"),
        "{said}"
    );
    assert!(robot.expect(&said).has_steppers_with_encoders());
    let weak = ["servo", "", "", "", "", "", ""];
    let strong = ["", "", "", "3.5", "", ""];
    let (robot, said) = hanging(&[&weak[..], &strong].concat());
    assert!(said.contains("cannot hold joint 1"), "{said}");
    assert!(robot.expect(&said).hobby_servos().is_some());
    // No arm of another kind is written when the answers end.
    for answers in [&blind[..], &weak, &[&weak[..], &[""; 6]].concat()] {
        let (robot, said) = hanging(answers);
        assert!(
            robot.is_none() && said.contains("the answers end"),
            "{said}"
        );
    }
}

#[test]
fn no_file_is_written_if_the_answers_end_early() {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &[], "name\n\n0.1\n");
    assert_eq!(output.status.code(), Some(1));
    assert!(
        message(&output).contains("the answers end at \"Cranks"),
        "{}",
        message(&output)
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_suggested_command_runs() {
    let folder = tempfile::tempdir().unwrap();
    let fivebar = Path::new(env!("CARGO_BIN_EXE_fivebar"));
    for name in ["arm.toml", "Lisa's Ärmchen.toml"] {
        let output = Command::new(fivebar)
            .args(["new", name, "--defaults"])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let message = String::from_utf8(output.stdout).unwrap();
        let (_, offered) = message
            .split_once("Try it: fivebar sim ")
            .expect("a suggested command");
        let offered = format!(
            "workspace --resolution 8 {}",
            offered.replace("--robot ", "")
        );
        let run = Command::new("sh")
            .args(["-c", &format!("'{}' {offered}", fivebar.display())])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert!(run.status.success(), "{offered}");
    }
}

/// Makes an arm from these answers and runs the suggested `fivebar sim`. Returns the messages of
/// `fivebar new`, the suggestion, and the output of the run.
fn new_then_sim(answers: [&str; 10]) -> (String, String, Output) {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &[], &(answers.join("\n") + "\n"));
    let message = message(&output);
    assert!(output.status.success(), "{message}");
    let offer = String::from_utf8(output.stdout).unwrap();
    let (_, command) = offer.split_once("fivebar ").expect("a suggested command");
    let run = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .args(command.split_whitespace())
        .current_dir(folder.path())
        .output()
        .unwrap();
    (message, offer, run)
}

#[test]
fn the_command_for_a_small_arm_scales_the_drawing() {
    let (message, offer, run) = new_then_sim(["", "", "0.02", "", "", "", "", "", "", ""]);
    assert!(!message.contains("cannot draw"), "{message}");
    assert!(
        offer.contains("fivebar sim --robot") && offer.contains("--scale 0.2"),
        "{offer}"
    );
    assert!(run.status.success(), "{run:?}");
}

#[test]
fn homing_holds_an_upright_arm_and_has_torque_left_to_move_it() {
    // The weight needs 196 mN·m at home. A level arm is homed with 225 mN·m.
    let (message, _, run) = new_then_sim(["", "up", "", "0.1", "0.5", "", "", "", "", ""]);
    assert!(!message.contains("cannot draw"), "{message}");
    assert!(run.status.success(), "{run:?}");
}

#[test]
fn an_arm_that_cannot_draw_is_reported_with_the_reason_of_its_run() {
    let heavy = ["", "", "", "", "", "", "", "10", "", ""];
    let homing = ["while homing", "225 mN·m at joint 1"];
    let upright = ["", "up", "", "", "", "", "", "1", "", ""];
    let holding = [
        "joint 1 does not have the torque to hold the arm",
        "even at a scale",
    ];
    for (answers, words) in [(heavy, homing), (upright, holding)] {
        let (message_of_new, offer, run) = new_then_sim(answers);
        let (_, reason) = message_of_new
            .split_once("cannot draw the demonstration: ")
            .unwrap();
        for word in words {
            assert!(reason.contains(word), "`{word}` is missing in: {reason}");
        }
        assert!(!offer.contains("Try it"), "{offer}");
        assert_eq!(run.status.code(), Some(1));
        // A run at full size has the same reason, possibly at another position.
        let (same, _) = reason.split_once(" at (").unwrap_or((reason, ""));
        let same = same.trim().trim_end_matches('.');
        assert!(message(&run).contains(same), "{} for {same}", message(&run));
    }
}

#[test]
fn the_image_of_a_board_is_named_for_each_kind_of_motor() {
    let images = [
        ("typical", " for the image stm32f405 ("),
        ("stepper", " for the image stm32f405_stepper ("),
        ("can", " for the image stm32f405_can ("),
        ("servo", " for the image rp2350_servo ("),
        ("ideal", "arm.toml. "),
    ];
    for (motors, named) in images {
        let answers = ["", "", "", "", "", "", "", "", "", motors].join("\n") + &"\n".repeat(16);
        let folder = tempfile::tempdir().unwrap();
        let output = new(folder.path(), &[], &answers);
        let wrote = String::from_utf8(output.stdout.clone()).unwrap();
        assert!(wrote.contains(named), "{wrote} {}", message(&output));
    }
}

#[test]
fn where_two_boards_have_an_image_the_board_is_asked_for() {
    let defaults = [""; 9];
    let answers = [&defaults[..], &["stepper"], &defaults, &["due", "pico2"]].concat();
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &[], &(answers.join("\n") + "\n"));
    let wrote = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(wrote.contains(" for the image rp2350_stepper ("), "{wrote}");
    let said = message(&output);
    assert!(
        said.contains("Not valid: due; answer stm32f405 or pico2"),
        "{said}"
    );
}

/// The figures of the petal on the arm of these answers.
fn petal_of(answers: &[&str]) -> (Robot, serde_json::Value) {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &[], &(answers.join("\n") + "\n"));
    let message = message(&output);
    assert!(output.status.success(), "{message}");
    assert!(!message.contains("Not valid"), "{message}");
    let run = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["sim", PETAL, "--robot", "arm.toml", "--json"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    (
        load(folder.path()),
        serde_json::from_slice(&run.stdout).unwrap(),
    )
}

/// The answers before those about the motors: all defaults.
const ARM: [&str; 9] = [""; 9];

#[test]
fn steppers_of_own_data_draw_without_losing_a_step() {
    // Gear, full steps, micro-steps, holding torque, current, resistance, inductance, rotor inertia, driver.
    let motor = ["-5", "400", "8", "0,3", "1.2A", "2.4", "4 mH", "3.5e-6"];
    let of = |driver| [&ARM[..], &["stepper"], &motor, &[driver]].concat();
    let (robot, figures) = petal_of(&of(""));
    let [stepper, other] = robot.steppers().unwrap();
    assert_eq!(stepper, other);
    assert_eq!((stepper.gear_ratio, stepper.microsteps), (-5.0, 8));
    assert_eq!(stepper.driver, DriverMode::Current);
    assert_eq!(figures["lost_steps"], serde_json::json!([0, 0]));
    let rms = figures["tip_error"]["rms_m"].as_f64().unwrap();
    assert!(rms < 1e-4, "{rms} m");
    // On drivers that give a voltage it comes late.
    let (robot, figures) = petal_of(&of("voltage"));
    let drivers = robot.steppers().unwrap().map(|stepper| stepper.driver);
    assert_eq!(drivers, [DriverMode::Voltage; 2]);
    let late = figures["tip_error"]["rms_m"].as_f64().unwrap();
    assert!(late > 1.5 * rms, "{late} m for {rms} m");
}

#[test]
fn motors_that_are_too_slow_for_the_usual_speed_lower_it() {
    let mut draft = Draft::new("slow");
    let usual = draft.check().unwrap().limits.max_speed;
    let stepper = StepperMotor::TYPICAL;
    draft.motors = Motors::Steppers(stepper.clone());
    assert_eq!(draft.check().unwrap().limits.max_speed, usual);
    for motors in [
        Motors::Steppers(StepperMotor {
            gear_ratio: 40.0,
            ..stepper.clone()
        }),
        Motors::Steppers(StepperMotor {
            microsteps: 256,
            ..stepper
        }),
        Motors::CanDrives(CanMotor {
            max_speed: 10.0,
            ..CanMotor::TYPICAL_MIT
        }),
    ] {
        draft.motors = motors;
        let speeds = draft.check().unwrap().limits.max_speed;
        assert!(speeds[0] < usual[0] && speeds[0] == speeds[1], "{speeds:?}");
    }
}

#[test]
fn drives_on_a_can_bus_draw_in_both_protocols() {
    for drives in [["odrive"].as_slice(), &["mit", "", "", "", "3, 4"]] {
        let blank = vec![""; 10];
        let (robot, figures) = petal_of(&[&ARM[..], &["can"], drives, &blank].concat());
        let nodes = robot.can_drives().unwrap().map(|drive| drive.node);
        assert_eq!(nodes, if drives.len() == 1 { [1, 2] } else { [3, 4] });
        for drive in robot.actuators.unwrap() {
            let share = drive.coulomb_friction / drive.peak_torque();
            assert!((5e-3..1e-2).contains(&share), "{share} of the peak torque");
            assert!(drive.viscous_friction > 0.0);
        }
        let rms = figures["tip_error"]["rms_m"].as_f64().unwrap();
        assert!(rms < 1e-3, "{drives:?}: {rms} m");
    }
}

#[test]
fn hobby_servos_of_own_data_draw_within_millimetres() {
    // Widths, travel, speed, torque, dead band, pulses in a second.
    let motor = ["0.6 ms, 2.4 ms", "3.0", "8", "0.3 N·m", "2 µs", "300"];
    let (robot, figures) = petal_of(&[&ARM[..], &["servo"], &motor].concat());
    let [servo, _] = robot.hobby_servos().unwrap();
    assert_eq!(robot.supply.voltage, 6.0);
    assert_eq!(servo.pulse_range, [0.6e-3, 2.4e-3]);
    assert_eq!((servo.travel, servo.max_speed), (3.0, 8.0));
    assert_eq!((servo.stall_torque, servo.frame_rate), (0.3, 300.0));
    assert!((servo.dead_band - 2e-6).abs() < 1e-18);
    let rms = figures["tip_error"]["rms_m"].as_f64().unwrap();
    assert!((1e-4..3e-3).contains(&rms), "{rms} m");
}

#[test]
fn an_existing_file_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.toml"), "mine").unwrap();
    let output = new(folder.path(), &["--defaults"], "");
    assert_eq!(output.status.code(), Some(1));
    assert!(message(&output).contains("exists already"));
    let left = std::fs::read_to_string(folder.path().join("arm.toml")).unwrap();
    assert_eq!(left, "mine");
}

/// The keys of a section, taken from the reader's message for an unknown key.
fn known_keys(text: &str) -> Vec<String> {
    let refusal = Robot::parse("arm.toml", text).unwrap_err().to_string();
    let (_, expected) = refusal
        .split_once("expected")
        .unwrap_or_else(|| panic!("{refusal}"));
    let keys = expected.split('`').skip(1).step_by(2);
    keys.map(str::to_owned).collect()
}

#[test]
fn the_file_explains_every_key_with_its_unit() {
    // Dimensionless numbers, and values that are not numbers.
    const WITHOUT_UNIT: [&str; 29] = [
        "driver",
        "motion_torque",
        "protocol",
        "node",
        "steps_per_turn",
        "microsteps",
        "torque_share",
        "down_s",
        "up_s",
        "method",
        "samples",
        "name",
        "working_mode",
        "gear_ratio",
        "encoder_counts",
        "encoder_side",
        "damping",
        "over_speed",
        "over_current",
        "singularity_margin",
        "poisson_ratio",
        "restitution",
        "law",
        "friction",
        "allowed",
        "kind",
        "active_low",
        "forward",
        "scale_with_speed",
    ];
    let text = Draft::new("arm").text();
    // The file with an unknown key at its top, and below each section's head.
    let heads: Vec<&str> = text.lines().filter(|line| line.starts_with('[')).collect();
    let inside = heads
        .iter()
        .map(|head| text.replacen(head, &format!("{head}\nodd = 1"), 1));
    let keys: Vec<String> = [format!("odd = 1\n{text}")]
        .into_iter()
        .chain(inside)
        .flat_map(|text| known_keys(&text))
        .collect();
    assert!(keys.len() > 50, "{keys:?}");
    let sections = heads.iter().map(|head| head.trim_matches(['[', ']']));
    let sections: Vec<&str> = sections
        .map(|head| head.split(']').next().unwrap())
        .collect();
    for key in keys.iter().filter(|key| !sections.contains(&key.as_str())) {
        let assignment = format!("{key} = ");
        let line = text
            .lines()
            .find(|line| line.trim_start_matches("# ").starts_with(&assignment))
            .unwrap_or_else(|| panic!("the file does not contain `{key}`"));
        let (_, after) = line.split_once(" = ").unwrap();
        let (_, comment) = after
            .split_once('#')
            .unwrap_or_else(|| panic!("no comment: {line}"));
        let has_unit = comment.contains('[');
        assert!(
            has_unit || WITHOUT_UNIT.contains(&key.as_str()),
            "no unit: {line}"
        );
    }
}

#[test]
fn commented_keys_show_their_defaults() {
    // With the commented keys of these sections active, the robot is the same.
    let text = Draft::new("arm").text();
    let in_force: String = text
        .lines()
        .map(|line| match line.strip_prefix("# ") {
            // Of another kind of drive.
            Some(rest) if rest.contains("CAN bus") => line,
            Some(rest) if rest.starts_with("max_speed") || rest.starts_with("max_jerk") => rest,
            _ => line,
        })
        .fold(String::new(), |text, line| text + line + "\n");
    assert_ne!(in_force, text);
    assert_eq!(Robot::parse("a", &in_force), Robot::parse("a", &text));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_draft_is_read_back_with_the_same_values(
        name in "[^\\p{Cc}]{1,12}",
        base in 0.01..0.6_f64, cranks in prop::array::uniform2(0.01..0.6_f64),
        couplers in prop::array::uniform2(0.01..0.6_f64),
        masses in prop::array::uniform4(1e-3..2.0_f64),
        payload in 0.0..3.0_f64, upright in any::<bool>(), driven in any::<bool>(),
    ) {
        let mut draft = Draft::new(&name);
        draft.upright = upright;
        draft.set_base(base);
        draft.set_cranks(cranks);
        draft.set_couplers(couplers);
        draft.crank_masses = [masses[0], masses[1]];
        draft.coupler_masses = [masses[2], masses[3]];
        draft.payload = payload;
        if !driven {
            draft.motors = Motors::Ideal;
        }
        // Many random lengths cannot be assembled; most can.
        let checked = draft.check();
        prop_assume!(checked.is_ok());
        let robot = checked.unwrap();
        prop_assert_eq!(&robot.name, &name);
        let lengths = [cranks[0], couplers[0], couplers[1], cranks[1], base];
        prop_assert_eq!(robot.geometry.lengths(), lengths);
        let arm = robot.arm().unwrap();
        prop_assert_eq!(arm.payload(), payload);
        let [m1, m2, m3, m4] = arm.links().map(|link| link.mass);
        prop_assert_eq!([m1, m4, m2, m3], masses);
        prop_assert_eq!(robot.actuators.is_some(), driven);
    }
}

#[test]
fn the_stepper_that_is_proposed_is_the_one_of_the_list_of_parts() {
    let document = include_str!("../../../../docs/use/parts.md");
    let line = document
        .lines()
        .find(|line| line.starts_with("| motors, 2 | StepperOnline"))
        .expect("the row of the steppers' motors");
    let motor = StepperMotor::TYPICAL;
    let figures = format!(
        "{:.2} N·m, {:.1} A, {:.1} Ω, {:.1} mH, {}°",
        motor.holding_torque,
        motor.rated_current,
        motor.resistance,
        1e3 * motor.inductance,
        360.0 / f64::from(motor.steps_per_turn)
    );
    let inertia = format!("{:.0} g·cm²", 1e7 * motor.rotor_inertia);
    assert!(
        line.contains(&figures) && line.contains(&inertia),
        "{figures}, {inertia}: {line}"
    );
}
