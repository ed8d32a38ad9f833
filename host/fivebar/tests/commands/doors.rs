//! Commands that take an arm whatever turns its joints, and the sentence of those that need a known torque or encoders. The table of
//! all is docs/verify/data/doors.csv.

use crate::arms::{ARMS, text};
use crate::commission::{commission, record, value};
use fivebar_files::robot::{Draft, Robot};
use fivebar_testkit::program;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::Output;

/// Runs the program in a folder that has the file of this arm as arm.toml, and a job of one stroke [mm] as job.gcode.
fn run(folder: &Path, arm: &str, args: &[&str]) -> Output {
    fs::write(folder.join("arm.toml"), text(arm)).unwrap();
    fs::write(folder.join("job.gcode"), "G21 G90\nM3\nG1 X8 F600\nM5\n").unwrap();
    let mut program = program(env!("CARGO_BIN_EXE_fivebar"));
    program.args(args).current_dir(folder).output().unwrap()
}

/// The last line of the output of a command that does what it is asked for, as JSON.
fn answer(folder: &Path, arm: &str, args: &[&str]) -> Value {
    let output = run(folder, arm, args);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arm}: {message}");
    let text = String::from_utf8(output.stdout).unwrap();
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

/// The message of a command that is refused.
fn refusal(folder: &Path, arm: &str, args: &[&str]) -> String {
    let output = run(folder, arm, args);
    assert_eq!(output.status.code(), Some(1), "{arm}: {args:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// What the messages call the drives of an arm, if they are no brushed motors.
fn other_drives(arm: &str) -> Option<&'static str> {
    match arm {
        "benchtop" => None,
        "benchtop_stepper" | "new" => Some("has steppers"),
        "leg" | "mit" => Some("has drives on a CAN bus"),
        _ => Some("has hobby servos"),
    }
}

const SIM: [&str; 7] = [
    "sim",
    "job.gcode",
    "--robot",
    "arm.toml",
    "--json",
    "--out",
    "out",
];

#[test]
fn a_stroke_is_simulated_with_its_trace_and_report_whatever_turns_the_joints() {
    for arm in ARMS {
        let folder = tempfile::tempdir().unwrap();
        let found = answer(folder.path(), arm, &SIM);
        assert_eq!(found["drawn"], true, "{arm}: {found}");
        let trace = fs::read_to_string(folder.path().join("out/trace.csv")).unwrap();
        assert!(trace.lines().count() > 100, "{arm}");
        let report = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
        assert!(!report.contains("NaN"), "{arm}");
    }
}

#[cfg(feature = "mcap")]
#[test]
fn a_run_has_a_log_for_foxglove_whatever_turns_the_joints() {
    for arm in ARMS {
        let folder = tempfile::tempdir().unwrap();
        answer(
            folder.path(),
            arm,
            &[&SIM[..], &["--log", "run.mcap"]].concat(),
        );
        let log = fs::read(folder.path().join("run.mcap")).unwrap();
        let messages = mcap::MessageStream::new(&log).unwrap();
        let messages: Result<Vec<_>, _> = messages.collect();
        let count = messages.unwrap().len();
        assert!(count > 100, "{arm}: {count}");
    }
}

#[test]
fn identify_and_margins_take_motors_whose_torque_is_known_and_tell_others_what_applies_to_them() {
    let folder = tempfile::tempdir().unwrap();
    for arm in ARMS {
        for args in [
            &["identify", "--robot", "arm.toml", "--propose", "--json"][..],
            &["margins", "arm.toml", "--json"],
        ] {
            let without_torque = other_drives(arm).filter(|drives| !drives.contains("CAN bus"));
            let Some(drives) = without_torque else {
                assert!(answer(folder.path(), arm, args).is_object());
                continue;
            };
            let message = refusal(folder.path(), arm, args);
            assert!(
                message.contains(drives) && message.contains("`fivebar sim`"),
                "{arm}: {message}"
            );
        }
    }
}

#[test]
fn runs_are_repeated_and_learnt_with_encoders_and_others_are_told_why_not() {
    for arm in ARMS {
        let folder = tempfile::tempdir().unwrap();
        let twice = [&SIM[..], &["--repeat", "2"]].concat();
        let learn = [&twice[..], &["--learn"]].concat();
        let blind = "has none: leave out --repeat and --learn";
        let is_refused = |args: &[&str], remedy: &str| {
            let message = refusal(folder.path(), arm, args);
            assert!(message.contains(remedy), "{arm}: {message}");
        };
        match other_drives(arm) {
            Some("has steppers" | "has hobby servos") => {
                is_refused(&twice, blind);
                is_refused(&learn, blind);
                continue;
            }
            _ => {
                let found = answer(folder.path(), arm, &learn);
                assert!(found["learning"].is_object(), "{arm}: {found}");
                assert!(folder.path().join("out/learnt.json").exists(), "{arm}");
            }
        }
        let found = answer(folder.path(), arm, &twice);
        assert_eq!(found["runs"].as_array().unwrap().len(), 2, "{arm}");
        assert_eq!(found["repeats_m"].as_array().unwrap().len(), 2, "{arm}");
    }
}

/// Holes at the places that are proposed, touched by an arm exactly as its file has it.
#[test]
fn the_holes_that_are_proposed_give_the_lengths_of_the_file_whatever_turns_the_joints() {
    for arm in ARMS {
        let folder = tempfile::tempdir().unwrap();
        let propose = [
            "calibrate",
            "--robot",
            "arm.toml",
            "--propose",
            "24",
            "--json",
        ];
        let proposed = answer(folder.path(), arm, &propose);
        let robot = Robot::parse(arm, &text(arm)).unwrap();
        let tool = robot.tool_on_link().unwrap();
        let mut table = String::from("counts1,counts4,x,y\n");
        for place in proposed["poses"].as_array().unwrap() {
            let [x, y] = [0, 1].map(|axis| place[axis].as_f64().unwrap());
            let pose = tool.inverse([x, y].into(), robot.elbows).unwrap();
            let [theta1, _, _, theta4] = pose.angles();
            let drives = robot.actuators.as_ref().unwrap().iter();
            for (drive, theta) in drives.zip([theta1, theta4]) {
                let per_turn = f64::from(drive.encoder_counts) * drive.gear_ratio;
                table += &format!("{},", (theta / TAU * per_turn).round());
            }
            table += &format!("{x},{y}\n");
        }
        fs::write(folder.path().join("touched.csv"), table).unwrap();
        let points = [
            "calibrate",
            "--robot",
            "arm.toml",
            "--points",
            "touched.csv",
            "--json",
        ];
        let found = answer(folder.path(), arm, &points);
        for (index, length) in robot.geometry.lengths().into_iter().enumerate() {
            let found = found["link_lengths"][index].as_f64().unwrap();
            assert!(
                (found - length).abs() < 0.5e-3,
                "{arm}: {found} m for {length} m"
            );
        }
    }
}

#[test]
fn marks_for_a_photograph_are_drawn_around_a_job_whatever_turns_the_joints() {
    for arm in ARMS {
        let folder = tempfile::tempdir().unwrap();
        let marks = [
            "photo",
            "job.gcode",
            "--robot",
            "arm.toml",
            "--draw-marks",
            "marks.gcode",
            "--json",
        ];
        let found = answer(folder.path(), arm, &marks);
        assert_eq!(found["marks_m"].as_array().unwrap().len(), 4, "{arm}");
        let drawn = [
            "sim",
            "marks.gcode",
            "--robot",
            "arm.toml",
            "--json",
            "--out",
            "out",
        ];
        assert_eq!(answer(folder.path(), arm, &drawn)["drawn"], true, "{arm}");
    }
}

/// The arm of `fivebar new`, with a fifth of the ticks, for a quick test.
/// Its limits of the angles keep holes and motions in front of its base.
#[test]
fn an_arm_of_defaults_is_commissioned_to_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let made = fivebar_testkit::program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["new", "arm.toml", "--defaults"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(made.status.success());
    let file = folder.path().join("arm.toml");
    let output = commission(folder.path(), &["--robot", &file.display().to_string()]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    let record = record(folder.path());
    assert_eq!(record["steps"].as_array().unwrap().len(), 13);
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(
        told.contains("  – left out: the robot file states no `stiffness`"),
        "{told}"
    );
    assert!(told.contains("  ✓ tip error"), "{told}");
    let after = value(&record, "tip_error_after_rms_m");
    assert!(after < 40e-6, "{after} m");
}

#[test]
fn a_new_arm_is_commissioned_to_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let slow = "[control]\ntick_rate = 2000.0\n";
    let drawing = text("new").replacen("[control]\n", slow, 1);
    let file = folder.path().join("arm.toml");
    fs::write(&file, drawing).unwrap();
    let output = commission(folder.path(), &["--robot", &file.display().to_string()]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    let after = value(&record(folder.path()), "tip_error_after_rms_m");
    assert!(after < 0.3e-3, "{after} m");
}

/// With other sizes, and upright, where the steps before homing leave the joints far behind their switches.
#[test]
fn arms_of_new_of_other_sizes_are_commissioned_to_the_end() {
    let mut wide = Draft::new("wide");
    wide.set_base(0.2);
    wide.set_cranks([0.15; 2]);
    wide.set_couplers([0.3; 2]);
    let mut upright = Draft::new("upright");
    upright.upright = true;
    for draft in [wide, upright] {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("arm.toml");
        fs::write(&file, draft.text()).unwrap();
        let output = commission(folder.path(), &["--robot", &file.display().to_string()]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {message}", draft.name);
        let record = record(folder.path());
        assert_eq!(record["steps"].as_array().unwrap().len(), 13);
    }
}

/// The hand's motion: 1 cm to the right, down, and back.
const HAND: &str = "t,x,y\n1,0.01,0\n2,0.01,-0.01\n3,0,0\n";

#[test]
fn a_hand_teaches_arms_with_brushed_motors_and_others_are_told_why_not() {
    for arm in ARMS {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("hand.csv"), HAND).unwrap();
        let teach = [
            "teach",
            "--robot",
            "arm.toml",
            "--hand",
            "hand.csv",
            "--out",
            "wave.json",
        ];
        let why = match other_drives(arm) {
            None => None,
            Some("has drives on a CAN bus") => Some("over a CAN bus"),
            Some(_) => Some("steppers and hobby servos"),
        };
        if let Some(why) = why {
            let message = refusal(folder, arm, &teach);
            assert!(message.contains(why), "{arm}: {message}");
            continue;
        }
        let output = run(folder, arm, &teach);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arm}: {message}");
        let path: Value =
            serde_json::from_str(&fs::read_to_string(folder.join("wave.json")).unwrap()).unwrap();
        let tip: Vec<[f64; 2]> = serde_json::from_value(path["tip_m"].clone()).unwrap();
        let span = |k: usize| {
            let values = tip.iter().map(|point| point[k]);
            values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
        };
        let spans = [span(0), span(1)];
        assert!(
            spans.iter().all(|it| (0.008..0.012).contains(it)),
            "{arm}: {spans:?}"
        );
        for (file, begins) in [
            ("wave.gcode", "G21 G90"),
            ("wave.svg", "<svg "),
            ("places.csv", "x_m,y_m\n"),
        ] {
            assert!(
                run(folder, arm, &["replay", "wave.json", "--out", file])
                    .status
                    .success()
            );
            let text = fs::read_to_string(folder.join(file)).unwrap();
            assert!(text.starts_with(begins), "{arm}: {text}");
        }
    }
}

#[test]
fn a_taught_path_is_done_again_whatever_turns_the_joints() {
    for arm in ARMS {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        fs::write(folder.join("arm.toml"), text(arm)).unwrap();
        let robot = Robot::load(folder.join("arm.toml").to_str().unwrap()).unwrap();
        let [x, y] = robot.tool_at(&robot.home_pose().unwrap());
        let tip: Vec<[f64; 2]> = (0..=100)
            .map(|k| {
                let u = f64::from(k) / 100.0;
                let share = (TAU * u * u * (3.0 - 2.0 * u)).cos();
                [x, y - 0.005 * (1.0 - share)]
            })
            .collect();
        let path = serde_json::json!({
            "taught_path": 1, "robot": robot.name, "knot_s": 0.02, "tip_m": tip,
        });
        fs::write(folder.join("wave.json"), path.to_string()).unwrap();
        let replay = [
            "replay",
            "wave.json",
            "--robot",
            "arm.toml",
            "--speed",
            "0.5",
        ];
        let output = run(folder, arm, &replay);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arm}: {message}");
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(said.contains("20.0 mm in 4.00 s done"), "{arm}: {said}");
        let other = ["replay", "wave.json", "--robot", "benchtop_pen"];
        let refused = refusal(folder, arm, &other);
        assert!(refused.contains("taught to"), "{arm}: {refused}");
    }
}
