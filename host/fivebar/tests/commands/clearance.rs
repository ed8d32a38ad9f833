//! The command `fivebar clearance`: the new and the worn arm under the production controller.

use fivebar_design::accuracy::five_bar::clearance_error;
use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_report::study::clearance::study;
use fivebar_testkit::program;
use serde_json::Value;
use std::process::Output;

/// A short line, so that the tests are fast.
const LINE: &str = "G21 G90 F6000\nG0 X0 Y0\nM3\nG1 X10 Y0\nM5\n";

fn fivebar(arguments: &[&str], out: &std::path::Path) -> Output {
    program(env!("CARGO_BIN_EXE_fivebar"))
        .arg("clearance")
        .args(arguments)
        .arg("--out")
        .arg(out)
        .output()
        .unwrap()
}

#[test]
fn the_new_arm_is_compared_with_the_worn_one() {
    let folder = tempfile::tempdir().unwrap();
    let job = folder.path().join("line.gcode");
    std::fs::write(&job, LINE).unwrap();
    let arguments = [
        "benchtop",
        job.to_str().unwrap(),
        "--radius",
        "30e-6",
        "--joints",
        "B,d",
        "--json",
    ];
    let output = fivebar(&arguments, folder.path());
    assert!(output.status.success(), "{output:?}");
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let [new, worn] = answer["runs"].as_array().unwrap().as_slice() else {
        panic!("two runs: {answer}");
    };
    let numbers = |run: &Value, key: &str| -> Vec<f64> {
        let list = run[key].as_array().unwrap();
        list.iter().map(|x| x.as_f64().unwrap()).collect()
    };
    assert_eq!(numbers(worn, "clearance_m"), [0.0, 30e-6, 0.0, 30e-6, 0.0]);
    assert_eq!(numbers(new, "impacts"), [0.0; 5]);
    for (joint, impacts) in numbers(worn, "impacts").into_iter().enumerate() {
        assert_eq!(impacts > 0.0, joint == 1 || joint == 3, "joint {joint}");
    }
    let peak = |run| numbers(run, "peak_reaction_n")[1];
    assert!(peak(worn) > 10.0 * peak(new));
    let pins = worn["pin_error"]["max_m"].as_f64().unwrap();
    assert!(pins > 10e-6 && new["pin_error"]["max_m"].as_f64().unwrap() < 1e-9);
    let report = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(report.contains("Reaction in B") && report.contains("30.0 µm"));
    assert!(folder.path().join("summary.json").exists());
}

/// The exact worst case is an independent model. At every sample, it bounds the distance of the
/// simulated tool from the position that follows from the crank angles.
#[test]
fn the_displacement_by_clearance_stays_within_the_exact_worst_case() {
    let robot = Robot::load("benchtop").unwrap();
    let scenario = Scenario::new("line", robot.clone(), "line", LINE.into());
    let job = scenario.job().unwrap();
    let clearance = [50e-6, 20e-6, 0.0, 30e-6, 50e-6];
    let study = study(&scenario, &job, &[clearance], &|| ()).unwrap();
    let assembly = robot.home_pose().unwrap().assembly();
    let worn = &study.outcomes[1];
    let mut nearest = 0.0_f64;
    for sample in worn.record.trace.samples() {
        let [theta1, theta4] = sample.angle;
        let pose = robot.geometry.forward(theta1, theta4, assembly).unwrap();
        let worst = clearance_error(&robot.geometry, &pose, clearance)
            .unwrap()
            .worst;
        let [x, y] = [sample.tool[0] - pose.c.x, sample.tool[1] - pose.c.y];
        nearest = nearest.max(x.hypot(y) / worst);
    }
    // The penetration adds to the distance.
    assert!((0.3..1.01).contains(&nearest), "{nearest}");
}

#[test]
fn invalid_options_and_files_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |arguments: &[&str], status: i32, reason: &str| {
        let output = fivebar(arguments, folder.path());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(status), "{message}");
        assert!(message.contains(reason), "{message}");
    };
    refused(&["benchtop", "--radius", "5e-3"], 1, "leaves no pin");
    refused(&["benchtop", "--radius", "-1e-6"], 2, "a length above 0");
    refused(&["benchtop", "--joints", "F"], 2, "joints from A to E");
    refused(&["duet"], 1, "clearance_radius");
    let contact = folder.path().join("arm.toml");
    let text = include_str!("../../../files/robots/benchtop.toml");
    for (line, reason) in [
        ("restitution = 1.5", "restitution"),
        ("law = \"newton\"", "newton"),
        ("poisson_ratio = 0.7", "poisson_ratio"),
        ("hardness = 3", "hardness"),
    ] {
        std::fs::write(&contact, format!("{text}\n[contact]\n{line}\n")).unwrap();
        refused(&[contact.to_str().unwrap()], 1, reason);
    }
}
