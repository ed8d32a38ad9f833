//! `fivebar commission` on the simulated arm: each wrong wiring is named, a run that ended goes on,
//! and a sound arm gets to the end.

use crate::commission_limits::assert_within_limits;
use fivebar_files::robot::Robot;
use fivebar_firmware::safety::DriveKind;
use fivebar_plant::Wiring;
use fivebar_testkit::program;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};
use std::time::Duration;

pub(crate) fn commission(folder: &Path, args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.args(["commission", "--port", "simulated", "--out"]);
    command.arg(folder.join("out")).args(args).output().unwrap()
}

/// Begins a commissioning and kills it after this time; its record is whole then.
pub(crate) fn killed_after(folder: &Path, args: &[&str], time: Duration) {
    let mut child = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["commission", "--port", "simulated", "--out"])
        .arg(folder.join("out"))
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(time);
    let _ = child.kill();
    child.wait().unwrap();
    if folder.join("out/record.json").exists() {
        record(folder);
    }
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs with these lines in the scenario; returns the output, which is a refusal.
fn refused(lines: &str) -> (String, String) {
    let folder = tempfile::tempdir().unwrap();
    let job = folder.path().join("dot.gcode");
    fs::write(job, "G1 X1 F600\n").unwrap();
    let scenario = folder.path().join("wired.toml");
    fs::write(&scenario, format!("job = \"dot.gcode\"\n{lines}\n")).unwrap();
    let scenario = scenario.display().to_string();
    let output = commission(folder.path(), &["--scenario", &scenario]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
    assert!(!folder.path().join("out/robot.toml").exists(), "{lines}");
    (text(&output.stdout), text(&output.stderr))
}

/// What is wrong, and what `commission` says of it.
const WRONG: &[(&str, &str)] = &[
    ("[wiring]\nmotors_swapped = true", "the motors are swapped"),
    (
        "[wiring]\nencoders_swapped = true",
        "the encoders are swapped",
    ),
    (
        "[wiring]\nmotor_reversed = [true, false]",
        "the motor of joint 1 is reversed",
    ),
    (
        "[wiring]\nmotor_reversed = [false, true]",
        "the motor of joint 4 is reversed",
    ),
    (
        "[wiring]\nencoder_reversed = [true, false]",
        "the encoder of joint 1 is reversed",
    ),
    (
        "[wiring]\nencoder_reversed = [false, true]",
        "the encoder of joint 4 is reversed",
    ),
    (
        "[wiring]\ncurrent_reversed = [true, false]",
        "current sense of joint 1 is reversed",
    ),
    (
        "[wiring]\ncurrent_reversed = [false, true]",
        "current sense of joint 4 is reversed",
    ),
    (
        "[wiring]\nmotor_dead = [false, true]",
        "motor channel of joint 4 is dead",
    ),
    (
        "[wiring]\nencoder_dead = [true, false]",
        "encoder of joint 1 is dead",
    ),
    (
        "[wiring]\ncurrent_dead = [false, true]",
        "current sensor of joint 4 is dead",
    ),
    (
        "[wiring]\nbridge_limit_missing = [true, false]",
        "the current limit of the bridge of joint 1 is missing",
    ),
    (
        "[wiring]\nbridge_limit_missing = [false, true]",
        "the current limit of the bridge of joint 4 is missing",
    ),
    (
        "[wiring]\ncounts = [1.0, 0.0]",
        "the counts or the gear ratio of joint 1 are wrong",
    ),
    (
        "[wiring]\ncounts = [0.0, -0.75]",
        "the counts or the gear ratio of joint 4 are wrong",
    ),
    (
        "[wiring]\nswitches_swapped = true",
        "the home switches are swapped",
    ),
    (
        "[wiring]\nswitch_inverted = [true, false]",
        "the home switch of joint 1 is stuck",
    ),
    (
        "[wiring]\nswitch_dead = [false, true]",
        "the home switch of joint 4 is stuck",
    ),
    (
        "[wiring]\nenable_dead = [true, false]",
        "motor channel of joint 1 is dead",
    ),
    (
        "[[fault]]\nkind = \"switch_stuck\"\njoint = 1\npressed = true",
        "the home switch of joint 1 is stuck",
    ),
    (
        "[[fault]]\nkind = \"switch_stuck\"\njoint = 4\npressed = false",
        "the home switch of joint 4 is stuck open",
    ),
    (
        "[[fault]]\nkind = \"bus_voltage\"\nvolts = 19.0",
        "the supply is wrong",
    ),
    (
        "[[fault]]\nkind = \"current_offset\"\njoint = 4\namperes = 1.0",
        "the current sensor of joint 4 reads code",
    ),
    (
        "[[fault]]\nkind = \"contactor_welded\"",
        "the bus stays at 24.0 V although the emergency stop is pressed",
    ),
    (
        "[[fault]]\nkind = \"bus_sensor_stuck\"",
        "the bus stays at 24.0 V although the emergency stop is pressed",
    ),
    (
        "[[fault]]\nkind = \"emergency_stop_welded\"",
        "the emergency stop was pressed and the controller does not see it",
    ),
    (
        "[[fault]]\nkind = \"emergency_stop\"",
        "the emergency stop reads as pressed",
    ),
];

#[test]
fn each_wrong_wiring_is_found_and_named() {
    for &(lines, wanted) in WRONG {
        let (_, message) = refused(lines);
        assert!(message.contains(wanted), "{lines}: {message}");
        assert!(message.contains("To do: "), "{message}");
    }
}

/// An index output without its wire is in home_index.rs, with an arm that needs it.
#[test]
fn every_key_of_the_wiring_of_brushed_motors_is_among_those_that_are_tried() {
    for key in Wiring::default().keys() {
        let is_of_brushed = key.kinds.contains(&DriveKind::Brushed);
        let line = format!("[wiring]\n{} = ", key.name);
        let is_tried = WRONG.iter().any(|(lines, _)| lines.starts_with(&line));
        let is_elsewhere = key.name == "index_dead";
        assert_eq!(is_of_brushed, is_tried || is_elsewhere, "{}", key.name);
    }
}

#[test]
fn two_mistakes_are_found_one_after_the_other() {
    let both = "[wiring]\nmotors_swapped = true\nmotor_reversed = [true, true]";
    let (_, message) = refused(both);
    assert!(message.contains("the motors are swapped"), "{message}");
    let both = "[wiring]\nmotor_reversed = [true, false]\ncurrent_reversed = [true, false]";
    let (_, message) = refused(both);
    assert!(
        message.contains("current sense of joint 1 is reversed"),
        "{message}"
    );
}

pub(crate) fn record(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("out/record.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

pub(crate) fn value(record: &Value, name: &str) -> f64 {
    let steps = record["steps"].as_array().unwrap();
    let mut values = steps
        .iter()
        .flat_map(|step| step["values"].as_array().unwrap());
    let found = values.find(|value| value["name"] == name).expect(name);
    found["value"].as_f64().unwrap()
}

#[test]
fn a_sound_arm_is_measured_and_a_run_that_ended_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let output = commission(folder.path(), &["--until", "homing"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let begun = record(folder.path());
    assert_eq!(begun["steps"].as_array().unwrap().len(), 6);
    let output = commission(folder.path(), &["--until", "validation"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("6/13 electrics: done on"));
    assert_within_limits(folder.path(), "the sound arm");
    let done = record(folder.path());
    assert_eq!(
        done["steps"].as_array().unwrap()[..6],
        begun["steps"].as_array().unwrap()[..]
    );
    assert_eq!(done["steps"].as_array().unwrap().len(), 12);
    for (name, wanted, share) in [
        ("resistance1", 2.3, 0.01),
        ("resistance4", 2.3, 0.01),
        ("inductance1", 0.24e-3, 0.01),
        ("inductance4", 0.24e-3, 0.01),
        ("torque_constant1", 0.0234, 0.01),
        ("torque_constant4", 0.0234, 0.01),
        // The drawing's base parameters with 10 % more mass and 20 g more payload.
        ("J1", 1.557_275e-3, 0.01),
        ("J4", 6.172_749e-4, 0.01),
        ("J2", 2.377_8e-3, 0.01),
        ("h2x", 1.504e-2, 0.01),
    ] {
        let found = value(&done, name);
        assert!(
            (found - wanted).abs() < share * wanted,
            "{name}: {found}, not {wanted}"
        );
    }
    let robot = Robot::load(&folder.path().join("out/robot.toml").display().to_string()).unwrap();
    // The declared mismatch: 30 % more friction.
    for drive in robot.actuators.unwrap() {
        assert!((drive.viscous_friction - 1.95e-3).abs() < 0.02 * 1.95e-3);
        assert!((drive.coulomb_friction - 1.17e-2).abs() < 0.02 * 1.17e-2);
    }
    // Along a second motion.
    let [torque, before, after] = ["rms", "error_before", "error_after"]
        .map(|which| value(&done, &format!("torque_{which}_nm")));
    assert!(
        after < 0.01 * torque && 10.0 * after < before,
        "{after} N·m after {before} N·m, of {torque} N·m"
    );
    let robot = fs::read_to_string(folder.path().join("out/robot.toml")).unwrap();
    for origin in [
        "by calibration; before: 0.10",
        "by back-EMF",
        "by identification",
    ] {
        assert!(robot.contains(origin), "{origin}");
    }
}

#[test]
fn an_arm_with_both_hips_about_one_axis_is_measured_by_its_holes() {
    let folder = tempfile::tempdir().unwrap();
    let benchtop = include_str!("../../../files/robots/benchtop.toml");
    let coaxial = benchtop.replace("base = 0.08", "base = 0.0");
    assert_ne!(coaxial, benchtop);
    let file = folder.path().join("coaxial.toml");
    fs::write(&file, coaxial).unwrap();
    let args = ["--robot", file.to_str().unwrap(), "--until", "dynamics"];
    let output = commission(folder.path(), &args);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("the plate's x axis is the arm's"));
    let record = record(folder.path());
    let held = ["base_m", "plate_phi_rad"].map(|name| value(&record, name));
    assert_eq!(held, [0.0; 2]);
    // Of 40 holes, as a plate for the built-in leg.
    assert!(value(&record, "tip_error_expected_m") < 12e-6);
    let robot = folder.path().join("out/robot.toml");
    let robot = Robot::load(&robot.display().to_string()).unwrap();
    let found = robot.geometry.lengths();
    for (found, made) in found.into_iter().zip([0.10, 0.16, 0.16, 0.10]) {
        assert!((found - made).abs() < 60e-6, "{found} m for {made} m");
    }
    assert_eq!(found[4], 0.0);
}

#[test]
fn bad_input_overwrites_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let output = commission(folder.path(), &["--until", "motors"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let path = folder.path().join("out/record.json");
    let before = fs::read(&path).unwrap();
    // Another robot.
    let output = commission(folder.path(), &["--robot", "benchtop_pen"]);
    assert!(
        text(&output.stderr).contains("record of another robot"),
        "{}",
        text(&output.stderr)
    );
    assert_eq!(fs::read(&path).unwrap(), before);
    // Holes that determine nothing.
    let holes = folder.path().join("holes.csv");
    fs::write(
        &holes,
        "counts1,counts4,x,y\n1,2,0.03,0.16\n5,9,0.04,0.17\n",
    )
    .unwrap();
    let holes = holes.display().to_string();
    let output = commission(folder.path(), &["--points", &holes]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stderr).contains("do not determine"),
        "{}",
        text(&output.stderr)
    );
    let kept = record(folder.path());
    assert_eq!(kept["steps"].as_array().unwrap().len(), 9);
    // A record that is none.
    fs::write(&path, "{").unwrap();
    let output = commission(folder.path(), &[]);
    assert!(text(&output.stderr).contains("no record of a commissioning"));
    assert_eq!(fs::read(&path).unwrap(), b"{");
}

#[test]
fn a_loose_belt_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let lines =
        "robot = \"benchtop_belt\"\njob = \"dot.gcode\"\n[mismatch]\nstiffness = [2400.0, 900.0]\n";
    fs::write(folder.path().join("dot.gcode"), "G1 X1 F600\n").unwrap();
    let scenario = folder.path().join("loose.toml");
    fs::write(&scenario, lines).unwrap();
    let scenario = scenario.display().to_string();
    let args = ["--robot", "benchtop_belt", "--scenario", &scenario];
    let output = commission(folder.path(), &args);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for words in [
        "the belt of joint 4 has ",
        "0.36 of the robot file's 2500",
        "loose or worn",
    ] {
        assert!(
            message.contains(words),
            "`{words}` is missing in: {message}"
        );
    }
    assert_within_limits(folder.path(), lines);
}

/// An arm as workshops build it. The tip is compared with the path on the touched plate, not with
/// what the controller believes. The run is killed twice and goes on. With the measured robot file the same arm then
/// learns the job. The figures are those of docs/use/bring-up.md and docs/design/learning.md.
#[test]
#[ignore = "two minutes: ./ci.sh tables"]
fn whole_table_of_what_commissioning_and_learning_take_of_the_realistic_arms_error() {
    commissioned_and_learnt(&[
        ("all its effects", &[]),
        ("without cogging", &["cogging"]),
        ("without stiction", &["stiction"]),
        ("without both", &["cogging", "stiction"]),
    ]);
}

/// A row of the table in docs/design/learning.md, and the effects that it leaves out.
type Row = (&'static str, &'static [&'static str]);

fn commissioned_and_learnt(rows: &[Row]) {
    let folder = tempfile::tempdir().unwrap();
    let scenario = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../files/scenarios/realistic.toml"
    );
    let args = ["--robot", "benchtop_belt", "--scenario", scenario];
    // In three parts, the second and third from the record of the one before.
    for until in ["friction", "dynamics"] {
        let part = commission(folder.path(), &[&args[..], &["--until", until]].concat());
        assert!(part.status.success(), "{}", text(&part.stderr));
    }
    let output = commission(folder.path(), &args);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record = record(folder.path());
    let [before, after] =
        ["before", "after"].map(|when| value(&record, &format!("tip_error_{when}_rms_m")));
    assert!((before - 77.1e-6).abs() < 1e-6, "{before} m");
    assert!((after - 9.2e-6).abs() < 1e-6, "{after} m after {before} m");
    let picture = fs::read_to_string(folder.path().join("out/validation.svg")).unwrap();
    for (when, rms) in [("before", before), ("after", after)] {
        let words = format!("{when}: {:.1} µm RMS", 1e6 * rms);
        assert!(picture.contains(&words), "{words}");
    }
    let robot = folder.path().join("out/robot.toml");
    let robot = Robot::load(&robot.display().to_string()).unwrap();
    for drive in robot.actuators.iter().flatten() {
        let [stiffness, damping] = [
            drive.stiffness.unwrap() / 2500.0,
            drive.drive_damping / 8e-3,
        ];
        assert!((stiffness - 1.0).abs() < 0.01, "{stiffness}");
        assert!((damping - 1.0).abs() < 0.1, "{damping}");
    }
    // 2.5 mrad of the first harmonic, at 0.4 and 2.6 rad.
    for (drive, phase) in robot.actuators.unwrap().iter().zip([0.4, 2.6]) {
        let first = drive.encoder_error.terms()[0];
        assert!((first.amplitude - 2.5e-3).abs() < 0.3e-3, "{first:?}");
        assert!((first.phase - phase).abs() < 0.13, "{first:?}");
    }
    let scenario = fs::read_to_string(scenario).unwrap();
    learns(folder.path(), &scenario);
    little_is_left_to_cogging_and_stiction(folder.path(), &scenario, rows);
}

/// The summary of the demonstration on the arm of this scenario, with the robot file that was measured.
fn drawn(folder: &Path, scenario: &str, options: &[&str]) -> Value {
    let measured = "robot = \"out/robot.toml\"\narm = \"benchtop_belt\"";
    let arm = scenario
        .replace("robot = \"benchtop_belt\"", measured)
        .replace("../jobs/fivebar.gcode", "fivebar.gcode");
    let job = include_str!("../../../files/jobs/fivebar.gcode");
    fs::write(folder.join("fivebar.gcode"), job).unwrap();
    fs::write(folder.join("measured.toml"), arm).unwrap();
    let output = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["sim", "measured.toml", "--json"])
        .args(options)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The demonstration three times.
fn learns(folder: &Path, scenario: &str) {
    let summary = drawn(folder, scenario, &["--repeat", "3", "--learn"]);
    let rms =
        |runs: &str, run: usize, of: &str| 1e6 * summary[runs][run][of]["rms_m"].as_f64().unwrap();
    let stated = [
        ("runs", "sensed", [2.9, 1.5, 1.4]),
        ("runs", "placed", [5.6, 5.0, 5.0]),
        ("pid_runs", "sensed", [17.2; 3]),
        ("pid_runs", "placed", [17.9; 3]),
    ];
    for (runs, of, stated) in stated {
        for (run, stated) in stated.into_iter().enumerate() {
            let found = rms(runs, run, of);
            assert!(
                (found - stated).abs() < 0.15 * stated,
                "{runs} {of} {run}: {found}"
            );
        }
    }
}

/// What a table of the cogging and a model of the stiction could give at most, as docs/design/learning.md has it.
fn little_is_left_to_cogging_and_stiction(folder: &Path, scenario: &str, rows: &[Row]) {
    let document = include_str!("../../../../docs/design/learning.md");
    for (row, effects) in rows {
        let is_kept = |line: &&str| !effects.iter().any(|effect| line.starts_with(effect));
        let arm: Vec<&str> = scenario.lines().filter(is_kept).collect();
        let summary = drawn(folder, &arm.join("\n"), &[]);
        let placed = 1e6 * summary["tip_error_placed"]["rms_m"].as_f64().unwrap();
        let row = format!("| {row} | {placed:.1} µm |");
        assert!(document.contains(&row), "learning.md lacks {row}");
    }
}

#[test]
fn an_arm_searches_for_its_switches_as_its_file_says() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("arm.toml");
    let benchtop = include_str!("../../../files/robots/benchtop.toml");
    let search = "[homing]\nforward = [false, true]\nspeed = 0.3\nback_off = 0.08\ncurrent = 0.9\n";
    fs::write(&robot, format!("{benchtop}\n{search}")).unwrap();
    let robot = robot.display().to_string();
    let output = commission(folder.path(), &["--robot", &robot, "--until", "friction"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record = record(folder.path());
    assert!(value(&record, "home_repeatability1_rad") < 1e-4);
    assert!(value(&record, "home_repeatability4_rad") < 1e-4);
}
