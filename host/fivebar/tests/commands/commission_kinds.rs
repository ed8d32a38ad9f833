//! `fivebar commission` on simulated arms with other drives than brushed motors: each wrong wiring is named by its step, and a
//! sound arm gets to the end.

use crate::commission::{commission, record, text, value};
use crate::commission_bus::{OF_ABSOLUTE, OF_BUS, OF_MIT};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_firmware::safety::DriveKind;
use fivebar_plant::Wiring;
use fivebar_testkit::program;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;

/// The demonstration, which a time-optimal plan draws with all of the torque that it may take.
const DEMONSTRATION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/fivebar.gcode");

/// A mistake in `[wiring]`, the step that finds it, and what it says.
pub(crate) type Mistake = (&'static str, &'static str, &'static str);

const OF_STEPPERS: &[Mistake] = &[
    (
        "switches_swapped = true",
        "switches",
        "the home switches are swapped",
    ),
    (
        "switch_inverted = [true, false]",
        "switches",
        "the home switch of joint 1 is stuck",
    ),
    (
        "switch_dead = [false, true]",
        "switches",
        "the home switch of joint 4 is stuck",
    ),
    (
        "enable_inverted = [false, true]",
        "enable",
        "the driver of joint 4 has power where it should have none",
    ),
    (
        "enable_dead = [true, false]",
        "enable",
        "the motor of joint 1 gets no power",
    ),
    (
        "motor_dead = [false, true]",
        "enable",
        "the motor of joint 4 gets no power",
    ),
    (
        "motors_swapped = true",
        "motors",
        "the motors are swapped: the driver of joint 1 turns joint 4",
    ),
    (
        "motor_reversed = [true, false]",
        "motors",
        "the motor of joint 1 is reversed",
    ),
    (
        "motor_reversed = [false, true]",
        "motors",
        "the motor of joint 4 is reversed",
    ),
    (
        "phase_dead = [true, false]",
        "motors",
        "the motor of joint 1 hums and does not turn: a phase is missing",
    ),
    (
        "phases_crossed = [false, true]",
        "motors",
        "the motor of joint 4 hums and does not turn",
    ),
    (
        "microsteps = [2.0, 1.0]",
        "micro-steps",
        "the micro-steps of joint 1 are wrong: it turns 0.5 times as far as it is told, so its driver makes 32",
    ),
    (
        "microsteps = [1.0, 0.5]",
        "micro-steps",
        "the micro-steps of joint 4 are wrong: it turns 2 times as far as it is told, so its driver makes 8",
    ),
];

/// Mistakes that the step `reserve` finds, with the begin of its sentence.
const OF_TORQUE: &[(&str, &str)] = &[
    (
        "current_share = [0.6, 1.0]",
        "the motor of joint 1 loses steps at 0.5 of the torque",
    ),
    (
        "current_share = [1.0, 0.6]",
        "the motor of joint 4 loses steps at 0.5 of the torque",
    ),
    (
        "supply_share = 0.35",
        "both motors lose steps at 0.5 of the torque",
    ),
];

/// What the same step says of a supply that makes the motors weaker at speed only.
const HALF_SUPPLY: [&str; 2] = ["supply_share = 0.5", "the supply may sag under load"];

/// Those of the encoders of steppers.
const OF_ENCODERS: &[Mistake] = &[
    (
        "encoders_swapped = true",
        "encoders",
        "the encoders are swapped",
    ),
    (
        "encoder_reversed = [true, false]",
        "encoders",
        "the encoder of joint 1 is reversed",
    ),
    (
        "encoder_dead = [false, true]",
        "encoders",
        "the encoder of joint 4 is dead",
    ),
    (
        "counts = [1.0, 0.0]",
        "encoders",
        "the counts or the gear ratio of joint 1 are wrong",
    ),
];

/// Of an arm that homes by the index pulses of such encoders.
const OF_INDEX: &[Mistake] = &[(
    "index_dead = [true, false]",
    "homing",
    "the index output of joint 1 reads high all the time",
)];

const OF_SERVOS: &[Mistake] = &[
    (
        "motors_swapped = true",
        "motors",
        "the servos are swapped: the output of joint 1 turns joint 4",
    ),
    (
        "motor_reversed = [false, true]",
        "motors",
        "the motor of joint 4 is reversed",
    ),
    (
        "signal_dead = [true, false]",
        "motors",
        "the motor of joint 1 gets no pulses, or its supply is too low",
    ),
    (
        "supply_share = 0.5",
        "motors",
        "gets no pulses, or its supply is too low",
    ),
];

/// The text of a built-in robot file with these changes.
pub(crate) fn changed(robot: &str, changes: &[(&str, &str)]) -> String {
    let mut text = BuiltIn::find(robot).unwrap().text.to_owned();
    for (before, after) in changes {
        assert!(text.contains(before), "{before}");
        text = text.replace(before, after);
    }
    text
}

/// A scenario of this robot in a file of this folder.
pub(crate) fn scenario(folder: &Path, robot: &str, lines: &str) -> String {
    fs::write(folder.join("dot.gcode"), "G1 X1 F600\n").unwrap();
    let file = folder.join("scenario.toml");
    let text = format!("robot = \"{robot}\"\njob = \"dot.gcode\"\n{lines}\n");
    fs::write(&file, text).unwrap();
    file.display().to_string()
}

/// Commissions in this folder with a mistake until it is refused; the step that refuses it, and what it says.
fn refused(folder: &Path, robot: &str, mistake: &str) -> (String, String) {
    let scenario = scenario(folder, robot, &format!("[wiring]\n{mistake}"));
    let output = commission(folder, &["--robot", robot, "--scenario", &scenario]);
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{mistake}: {told}");
    let mut titles = told.lines().filter(|line| !line.starts_with(' '));
    let last = titles.next_back().unwrap_or_default();
    let step = last.split([' ', ':']).nth(1).unwrap_or_default();
    (step.into(), text(&output.stderr))
}

pub(crate) fn each_is_named(robot: &str, mistakes: &[Mistake]) {
    for &(mistake, step, wanted) in mistakes {
        let folder = tempfile::tempdir().unwrap();
        let (refused_by, message) = refused(folder.path(), robot, mistake);
        assert_eq!(refused_by, step, "{mistake}: {message}");
        assert!(message.contains(wanted), "{mistake}: {message}");
        assert!(message.contains("To do: "), "{mistake}: {message}");
    }
}

#[test]
fn each_wrong_wiring_of_steppers_is_found_by_its_step_and_named() {
    each_is_named("benchtop_stepper", OF_STEPPERS);
}

#[test]
fn each_wrong_wiring_of_the_encoders_of_steppers_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let kind = "kind = \"stepper\"";
    let with_encoders = format!("{kind}\nencoder_counts = 4000");
    let by_switch = changed("benchtop_stepper", &[(kind, &with_encoders)]);
    let by_index = format!("{by_switch}\n[homing]\nmethod = \"index\"\n");
    for (name, text, mistakes) in [
        ("switch.toml", by_switch, OF_ENCODERS),
        ("index.toml", by_index, OF_INDEX),
    ] {
        let file = folder.path().join(name);
        fs::write(&file, text).unwrap();
        each_is_named(&file.display().to_string(), mistakes);
    }
}

#[test]
fn each_wrong_wiring_of_hobby_servos_is_found_by_its_step_and_named() {
    each_is_named("classroom_servo", OF_SERVOS);
}

#[test]
fn every_key_of_the_wiring_of_each_kind_is_among_those_that_are_tried() {
    let of_torque = OF_TORQUE.iter().map(|(mistake, _)| *mistake);
    let of_torque = of_torque.chain([HALF_SUPPLY[0]]);
    let of_steps = OF_STEPPERS.iter().map(|(mistake, ..)| *mistake);
    let of_steppers: Vec<&str> = of_steps.chain(of_torque).collect();
    let of_encoders = OF_ENCODERS
        .iter()
        .chain(OF_INDEX)
        .map(|(mistake, ..)| *mistake);
    let with_encoders: Vec<&str> = of_steppers.iter().copied().chain(of_encoders).collect();
    let of_bus = [OF_BUS, OF_MIT, OF_ABSOLUTE].concat();
    let of_bus: Vec<&str> = of_bus.iter().map(|(mistake, ..)| *mistake).collect();
    let of_servos: Vec<&str> = OF_SERVOS.iter().map(|(mistake, ..)| *mistake).collect();
    for (kind, mistakes) in [
        (DriveKind::Stepper, of_steppers),
        (DriveKind::StepperWithEncoder, with_encoders),
        (DriveKind::HobbyServo, of_servos),
        (DriveKind::CanTorque, of_bus),
    ] {
        for key in Wiring::default().keys() {
            let line = format!("{} = ", key.name);
            let is_tried = mistakes.iter().any(|mistake| mistake.starts_with(&line));
            assert_eq!(
                key.kinds.contains(&kind),
                is_tried,
                "{kind:?}: {}",
                key.name
            );
        }
    }
}

/// The torque that each motor of a robot file may take.
fn torque_shares(folder: &Path) -> [f64; 2] {
    let robot = Robot::load(&folder.join("out/robot.toml").display().to_string()).unwrap();
    let actuators = robot.actuators.unwrap();
    actuators.map(|drive| drive.stepper().unwrap().torque_share)
}

const STEPPER_ARM: &str = "benchtop_stepper";

/// The record of a sound arm on steppers up to the step before `reserve`.
static BEFORE_RESERVE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--robot", STEPPER_ARM, "--until", "reserve"];
    let output = commission(folder.path(), &args);
    assert!(output.status.success(), "{}", text(&output.stderr));
    fs::read(folder.path().join("out/record.json")).unwrap()
});

/// A folder in which the step `reserve` is the next one.
fn before_reserve() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out/record.json"), &*BEFORE_RESERVE).unwrap();
    folder
}

/// Does the step `reserve` with an arm of this scenario; the folder and what was said.
fn reserve_found(lines: &str) -> (tempfile::TempDir, String) {
    let folder = before_reserve();
    let scenario = scenario(folder.path(), STEPPER_ARM, lines);
    let args = ["--robot", STEPPER_ARM, "--until", "geometry"];
    let output = commission(
        folder.path(),
        &[&args[..], &["--scenario", &scenario]].concat(),
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    (folder, text(&output.stdout))
}

fn are_named_by_reserve(mistakes: &[(&str, &str)]) {
    for (mistake, wanted) in mistakes {
        let (step, message) = refused(before_reserve().path(), STEPPER_ARM, mistake);
        assert_eq!(step, "reserve", "{mistake}: {message}");
        assert!(message.contains(wanted), "{mistake}: {message}");
    }
}

#[test]
fn a_motor_or_a_supply_that_is_too_weak_is_named_by_the_torque_in_reserve() {
    are_named_by_reserve(&OF_TORQUE[1..]);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_motors_and_supplies_that_are_named_by_the_torque_in_reserve() {
    are_named_by_reserve(OF_TORQUE);
    let [half_supply, wanted] = HALF_SUPPLY;
    let (_, told) = reserve_found(&format!("[wiring]\n{half_supply}"));
    assert!(told.contains(wanted), "{told}");
}

/// Lighter than its file, the arm loses no steps, and its limits let it use no more torque: more is not claimed.
#[test]
fn torque_that_the_limits_do_not_let_a_light_arm_use_is_not_claimed() {
    let (folder, told) = reserve_found("[mismatch]\nlink_mass = -0.15");
    assert!(told.contains("not tried, because the limits"), "{told}");
    assert_eq!(torque_shares(folder.path()), [0.72; 2], "{told}");
}

#[test]
fn with_the_torque_in_reserve_that_was_found_an_unknown_arm_loses_no_steps() {
    let unknown = "[mismatch]\nlink_mass = 0.15\ntorque_constant = [-0.1, -0.1]";
    let (folder, told) = reserve_found(unknown);
    let record = record(folder.path());
    for (share, number) in torque_shares(folder.path()).into_iter().zip([1, 4]) {
        let found = value(&record, &format!("share{number}_without_loss"));
        assert!((0.45..0.75).contains(&found), "{told}");
        assert!((share - 0.8 * found).abs() < 6e-3, "{share} of {found}");
    }
    // As fast as the motors can, this arm loses no step at the measured share, and some at twice as much.
    let measured = folder.path().join("out/robot.toml").display().to_string();
    let overloaded = folder.path().join("overloaded.toml").display().to_string();
    let mut text = fs::read_to_string(&measured).unwrap();
    for share in torque_shares(folder.path()) {
        let line = format!("torque_share = {share}");
        assert!(text.contains(&line), "{line}");
        text = text.replacen(&line, &format!("torque_share = {:.3}", 2.0 * share), 1);
    }
    fs::write(&overloaded, text).unwrap();
    for (robot, is_drawn) in [(&overloaded, false), (&measured, true)] {
        let scenario = scenario(folder.path(), robot, unknown);
        let text = fs::read_to_string(&scenario).unwrap();
        fs::write(&scenario, text.replace("dot.gcode", DEMONSTRATION)).unwrap();
        let mut sim = program(env!("CARGO_BIN_EXE_fivebar"));
        sim.args(["sim", &scenario, "--time-optimal", "--out"]);
        let output = sim.arg(folder.path().join("sim")).output().unwrap();
        assert_eq!(
            output.status.success(),
            is_drawn,
            "{robot}: {}",
            self::text(&output.stdout)
        );
    }
}

/// The measured robot file of a whole commissioning of a simulated arm.
pub(crate) fn commissioned(folder: &Path, drawing: &str) -> Robot {
    let file = folder.join("arm.toml");
    fs::write(&file, drawing).unwrap();
    let output = commission(folder, &["--robot", &file.display().to_string()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    Robot::load(&folder.join("out/robot.toml").display().to_string()).unwrap()
}

#[test]
fn an_arm_on_steppers_with_other_lengths_and_gears_gets_to_the_end_and_knows_its_torque_in_reserve()
{
    let folder = tempfile::tempdir().unwrap();
    let drawing = changed(
        "benchtop_stepper",
        &[
            ("gear_ratio = 4.0", "gear_ratio = 3.0"),
            ("base = 0.08", "base = 0.10"),
            ("length = 0.10", "length = 0.12"),
            ("length = 0.16", "length = 0.19"),
            // A fifth of the ticks, for a quick test.
            (
                "[protection]",
                "[control]\ntick_rate = 2000.0\n\n[protection]",
            ),
        ],
    );
    commissioned(folder.path(), &drawing);
    let record = record(folder.path());
    assert_eq!(record["steps"].as_array().unwrap().len(), 11);
    for (share, number) in torque_shares(folder.path()).into_iter().zip([1, 4]) {
        let found = value(&record, &format!("share{number}_without_loss"));
        assert!((0.65..1.4).contains(&found), "{found}");
        assert!(
            (share - (0.8 * found).min(1.0)).abs() < 6e-3,
            "{share} of {found}"
        );
        let spread = value(&record, &format!("home_repeatability{number}_rad"));
        assert!(spread < 1e-3, "{spread}");
    }
    let after = value(&record, "tip_error_after_rms_m");
    assert!(after < 0.3e-3, "{after} m");
}

/// A slow arm whose drawing takes a minute at its own speed is drawn faster here, with a fifth of the ticks.
#[test]
fn a_sound_arm_on_hobby_servos_gets_to_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let drawing = changed(
        "classroom_servo",
        &[
            ("max_speed = 0.03", "max_speed = 0.3"),
            ("max_acceleration = 0.3", "max_acceleration = 3.0"),
            ("max_jerk = 5.0", "max_jerk = 100.0"),
            ("down_time = 0.2", "down_time = 0.02"),
            ("up_time = 0.2", "up_time = 0.02"),
            (
                "[supply]",
                "[control]\ntick_rate = 2000.0\ncurrent_bandwidth = 600.0\nbandwidth = 100.0\n\n[supply]",
            ),
        ],
    );
    let robot = commissioned(folder.path(), &drawing);
    // An offset of a joint is one of all its widths: the first pulse stays what it was.
    let widths = |robot: &Robot| robot.hobby_servos().unwrap().map(|servo| servo.home_width);
    let drawn = Robot::parse("drawn.toml", &drawing).unwrap();
    for (width, before) in widths(&robot).iter().zip(widths(&drawn)) {
        assert!((width - before).abs() < 1e-9, "{width} s after {before} s");
    }
    assert_ne!(robot.home, drawn.home);
    let record = record(folder.path());
    assert_eq!(record["steps"].as_array().unwrap().len(), 6);
    for number in [1, 4] {
        let found = value(&record, &format!("dead_band{number}_s"));
        assert!((2e-6..15e-6).contains(&found), "{found}");
    }
    // On its way to the first stroke the tool is 30 mm from where it is told to be.
    let greatest = value(&record, "tip_error_before_max_m");
    assert!(greatest < 15e-3, "{greatest} m");
    let after = value(&record, "tip_error_after_rms_m");
    assert!(after < 5e-3, "{after} m");
}

#[test]
fn a_step_of_another_kind_is_refused_with_the_steps_that_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["--robot", "benchtop_stepper", "--until", "electrics"];
    let output = commission(folder.path(), &args);
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert!(
        message.contains("this arm has no step electrics"),
        "{message}"
    );
    assert!(message.contains("micro-steps"), "{message}");
}
