//! `fivebar new` from the outside, and the robot files it writes.

use fivebar::input::robot::{Draft, Robot};
use proptest::prelude::*;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const PETAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/jobs/petal.gcode");

/// Runs `fivebar new arm.toml` in a folder with these lines as answers.
fn new(folder: &Path, arguments: &[&str], answers: &str) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_fivebar"))
        .args(["new", "arm.toml"])
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = program.stdin.take().unwrap();
    // A program that asks nothing may have left already.
    let _ = input.write_all(answers.as_bytes());
    drop(input);
    program.wait_with_output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn load(folder: &Path) -> Robot {
    Robot::load(folder.join("arm.toml").to_str().unwrap()).unwrap()
}

#[test]
fn an_arm_by_default_is_simulated_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &["--defaults"], "");
    assert!(output.status.success(), "{}", said(&output));
    assert_eq!(load(folder.path()).name, "arm");
    let run = Command::new(env!("CARGO_BIN_EXE_fivebar"))
        .args(["sim", PETAL, "--robot", "arm.toml", "--json"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", said(&run));
    let figures: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    assert!(
        figures["tip_error"]["rms_m"].as_f64().unwrap() < 5e-5,
        "{figures}"
    );
}

#[test]
fn answers_come_line_by_line_and_bad_ones_are_asked_for_again_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let answers = [
        "left hand",
        "sideways",
        "up",
        "0",
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
    let said = said(&output);
    assert!(output.status.success(), "{said}");
    for reason in [
        "\"sideways\" is none of flat, upright",
        "a length is more than 0 m, not -1",
        "\"wide\" is not the number",
        "\"nan\" is not the number",
        "long enough to meet?",
        "\"steam\" is none of",
        "`gear_ratio` of [[actuator]] 1 must be a finite number but 0",
        "\"4096.5\" is not the number",
    ] {
        assert!(said.contains(reason), "`{reason}` is missing in: {said}");
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
    // What gravity pulls must be held while unpowered.
    assert!(motor.brake_torque > 0.5, "{}", motor.brake_torque);
}

#[test]
fn answers_that_end_too_soon_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &[], "name\n\n0.1\n");
    assert_eq!(output.status.code(), Some(1));
    assert!(
        said(&output).contains("the answers end at \"Cranks"),
        "{}",
        said(&output)
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_command_it_offers_runs_as_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    let fivebar = Path::new(env!("CARGO_BIN_EXE_fivebar"));
    for name in ["arm.toml", "Lisa's Ärmchen.toml"] {
        let output = Command::new(fivebar)
            .args(["new", name, "--defaults"])
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        let (_, offered) = said.split_once("Try it: fivebar sim ").expect("an offer");
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

/// Makes an arm of these answers, runs what is offered with `fivebar sim`, and gives what was
/// said of the arm, what was offered, and the run.
fn tried(answers: [&str; 10]) -> (String, String, Output) {
    let folder = tempfile::tempdir().unwrap();
    let output = new(folder.path(), &[], &(answers.join("\n") + "\n"));
    let said = said(&output);
    assert!(output.status.success(), "{said}");
    let offer = String::from_utf8(output.stdout).unwrap();
    let (_, command) = offer.split_once("fivebar ").expect("an offer");
    let run = Command::new(env!("CARGO_BIN_EXE_fivebar"))
        .args(command.split_whitespace())
        .current_dir(folder.path())
        .output()
        .unwrap();
    (said, offer, run)
}

#[test]
fn a_small_arm_is_offered_a_drawing_of_its_size() {
    let (said, offer, run) = tried(["", "", "0.02", "", "", "", "", "", "", ""]);
    assert!(!said.contains("cannot draw"), "{said}");
    assert!(
        offer.contains("Try it: ") && offer.contains("--scale 0.2"),
        "{offer}"
    );
    assert!(run.status.success(), "{run:?}");
}

#[test]
fn homing_holds_an_upright_arm_up_and_has_torque_left_to_move_it() {
    // Its weight takes 196 mN·m at home; 225 mN·m are what a level arm is homed with.
    let (said, _, run) = tried(["", "up", "", "0.1", "0.5", "", "", "", "", ""]);
    assert!(!said.contains("cannot draw"), "{said}");
    assert!(run.status.success(), "{run:?}");
}

#[test]
fn an_arm_that_cannot_draw_is_told_of_with_the_reason_that_its_run_will_give() {
    let heavy = ["", "", "", "", "", "", "", "10", "", ""];
    let homing = ["while homing", "225 mN·m at joint 1"];
    let upright = ["", "up", "", "", "", "", "", "1", "", ""];
    let holding = [
        "joint 1 has not the torque to hold the arm",
        "even at a scale",
    ];
    for (answers, words) in [(heavy, homing), (upright, holding)] {
        let (told, offer, run) = tried(answers);
        let (_, reason) = told.split_once("cannot draw the demonstration: ").unwrap();
        for word in words {
            assert!(reason.contains(word), "`{word}` is missing in: {reason}");
        }
        assert!(!offer.contains("Try it"), "{offer}");
        assert_eq!(run.status.code(), Some(1));
        // A run at full size meets the same reason, at a place of its own.
        let (same, _) = reason.split_once(" at (").unwrap_or((reason, ""));
        let same = same.trim().trim_end_matches('.');
        assert!(said(&run).contains(same), "{} for {same}", said(&run));
    }
}

#[test]
fn a_file_that_is_there_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.toml"), "mine").unwrap();
    let output = new(folder.path(), &["--defaults"], "");
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("there already"));
    let left = std::fs::read_to_string(folder.path().join("arm.toml")).unwrap();
    assert_eq!(left, "mine");
}

/// The keys that the reader knows in a place, from what it says of one it does not.
fn known_keys(text: &str) -> Vec<String> {
    let refusal = Robot::parse("arm.toml", text).unwrap_err().to_string();
    let (_, expected) = refusal
        .split_once("expected")
        .unwrap_or_else(|| panic!("{refusal}"));
    let keys = expected.split('`').skip(1).step_by(2);
    keys.map(str::to_owned).collect()
}

#[test]
fn the_file_explains_every_key_that_the_reader_knows_with_its_unit() {
    // Numbers that have no unit, and what is no number.
    const WITHOUT_UNIT: [&str; 12] = [
        "name",
        "working_mode",
        "gear_ratio",
        "encoder_counts",
        "damping",
        "over_speed",
        "over_current",
        "singularity_margin",
        "poisson_ratio",
        "restitution",
        "law",
        "friction",
    ];
    let text = Draft::new("arm").text();
    // An unknown key on the line below each section's head, or on top of the file.
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
            .unwrap_or_else(|| panic!("the file does not tell of `{key}`"));
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
fn a_commented_key_holds_its_default() {
    // [tool] to [protection] as written, with every key in force, are the same robot.
    let text = Draft::new("arm").text();
    let in_force: String = text
        .lines()
        .map(|line| match line.strip_prefix("# ") {
            Some(rest) if rest.starts_with("max_speed") || rest.contains("bandwidth = ") => rest,
            _ => line,
        })
        .fold(String::new(), |text, line| text + line + "\n");
    assert_ne!(in_force, text);
    assert_eq!(Robot::parse("a", &in_force), Robot::parse("a", &text));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_a_draft_says_is_what_the_reader_reads(
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
            draft.motor = None;
        }
        // Lengths that cannot be assembled are many, but far from all.
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
