//! The methods of `[homing]` from the robot file to the simulated arm: hard stops, absolute encoders and
//! a jig, where no switch is asked for.

use crate::commission::{commission, record, text, value};
use fivebar_testkit::program;
use serde_json::Value;
use std::fs;
use std::path::Path;

const BENCHTOP: &str = include_str!("../../../files/robots/benchtop.toml");

/// The benchtop arm with hard stops 0.02 rad behind its limits.
fn with_stops() -> String {
    let near = "home = [3.57, -0.43]";
    let text = BENCHTOP.replace("home = [2.7925268, 0.3490659]", near);
    assert!(text.contains(near));
    text + "\n[homing]\nmethod = \"hard-stop\"\ncurrent = 0.8\n"
}

/// Commissions this arm until after homing. Returns the record, and what the arm did in that step.
fn homed(folder: &Path, text_of_robot: &str) -> (Value, Value) {
    let robot = folder.join("arm.toml");
    fs::write(&robot, text_of_robot).unwrap();
    let robot = robot.display().to_string();
    let output = commission(folder, &["--robot", &robot, "--until", "friction"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    assert!(said.contains("the arm is homed without switches"), "{said}");
    let seen = fs::read_to_string(folder.join("out/simulated.json")).unwrap();
    let steps: Vec<Value> = serde_json::from_str(&seen).unwrap();
    let homing = steps.into_iter().find(|step| step["step"] == "homing");
    (record(folder), homing.unwrap())
}

#[test]
fn an_arm_with_hard_stops_finds_its_angles_gently() {
    let folder = tempfile::tempdir().unwrap();
    let (found, homing) = homed(folder.path(), &with_stops());
    for joint in [1, 4] {
        let spread = value(&found, &format!("home_repeatability{joint}_rad"));
        assert!(spread < 1e-4, "{spread} rad");
    }
    let number = |key: &str| homing[key].as_f64().unwrap();
    // 0.7 rad/s against a stop.
    assert!(number("kinetic_energy_j") < 1e-3, "{homing}");
    // The stops are at 3.62 and −0.48 rad and yield by 0.15 mrad; an impact adds some.
    for (joint, end, stop) in [(0, 1, 3.62), (1, 0, -0.48)] {
        let farthest = homing["angle_rad"][joint][end].as_f64().unwrap();
        assert!((farthest - stop).abs() < 1e-3, "{homing}");
    }
}

/// The tip error of the demonstration with this robot file, root mean square [m].
pub(crate) fn demonstrated(robot: &str) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arm.toml");
    fs::write(&file, robot).unwrap();
    let output = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["sim", "--json", "--robot"])
        .arg(&file)
        .arg("--out")
        .arg(folder.path().join("out"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    let summary: Value = serde_json::from_str(said.lines().last().unwrap()).unwrap();
    summary["tip_error"]["rms_m"].as_f64().unwrap()
}

/// The controller's belief is off by what the stops yield, and no more.
#[test]
fn a_drawing_after_a_search_for_hard_stops_is_where_the_drawing_is() {
    let rms = demonstrated(&with_stops());
    assert!(rms > 5e-6 && rms < 40e-6, "{rms} m");
}

#[test]
fn absolute_encoders_and_a_jig_need_no_motion() {
    let counts = "encoder_counts = 16384";
    let at_joints = BENCHTOP.replace(counts, &format!("{counts}\nencoder_side = \"joint\""));
    for text in [
        at_joints + "\n[homing]\nmethod = \"absolute\"\n",
        BENCHTOP.to_owned() + "\n[homing]\nmethod = \"given\"\n",
    ] {
        let folder = tempfile::tempdir().unwrap();
        let (found, homing) = homed(folder.path(), &text);
        for joint in [0, 1] {
            let travel = homing["travel_rad"][joint].as_f64().unwrap();
            assert!(travel < 1e-4, "{homing}");
            let number = 1 + 3 * joint;
            let spread = value(&found, &format!("home_repeatability{number}_rad"));
            assert!(spread < 1e-3, "{spread} rad");
        }
    }
}
