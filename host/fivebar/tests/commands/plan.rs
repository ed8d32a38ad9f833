//! The command `fivebar plan`: its keys, options and refusals.

use fivebar_testkit::program;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Output;

fn plan(args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.arg("plan").args(args).output().unwrap()
}

fn answer(args: &[&str]) -> Value {
    let output = plan(&[args, &["--json"]].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn refusal(args: &[&str], status: i32) -> String {
    let output = plan(args);
    assert_eq!(output.status.code(), Some(status));
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr).unwrap()
}

fn shipped(path: &str) -> String {
    format!("{}/../files/{path}", env!("CARGO_MANIFEST_DIR"))
}

fn written(folder: &Path, case: &Value) -> PathBuf {
    let path = folder.join("case.json");
    std::fs::write(&path, case.to_string()).unwrap();
    path
}

fn line() -> Value {
    json!({
        "name": "line",
        "working_mode": ["right", "left"],
        "limits": { "torque": [0.7488, 0.7488], "speed": [35, 35], "acceleration": [1000, 1000] },
        "path": [{ "kind": "line", "from": [-0.06, 0.12], "to": [0.14, 0.2] }],
        "optimal_time_s": 0.1,
    })
}

#[test]
fn a_run_has_every_key_at_even_places() {
    let found = answer(&[
        "--robot",
        "benchtop",
        "--path",
        &shipped("paths/square.json"),
    ]);
    let runs = found["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 4);
    let mut total = 0.0;
    for run in runs {
        let list = |key: &str| -> Vec<f64> {
            let values = run[key].as_array().unwrap().iter();
            values.map(|value| value.as_f64().unwrap()).collect()
        };
        let (s, t) = (list("s"), list("t"));
        assert!(s.len() >= 41);
        let length = run["length"].as_f64().unwrap();
        assert!((length - 0.06).abs() < 1e-12);
        for (k, place) in s.iter().enumerate() {
            assert!((place - length * k as f64 / (s.len() - 1) as f64).abs() < 1e-12);
        }
        for key in ["sdot", "torque1_nm", "torque4_nm"] {
            assert_eq!(list(key).len(), s.len());
        }
        assert_eq!((t[0], t[t.len() - 1]), (0.0, run["time"].as_f64().unwrap()));
        assert!(t.windows(2).all(|pair| pair[0] < pair[1]));
        total += t[t.len() - 1];
    }
    assert!((found["time_s"].as_f64().unwrap() - total).abs() < 1e-12);
    assert!(found["active_share"].as_f64().unwrap() > 0.95);
    assert!(found["limit_excess"].as_f64().unwrap() < 5e-3);
}

#[test]
fn options_change_the_plan_and_the_report_opens_offline() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), &line());
    let path = path.to_str().unwrap();
    let time = |args: &[&str]| {
        answer(&[&["--path", path], args].concat())["time_s"]
            .as_f64()
            .unwrap()
    };
    let full = time(&[]);
    assert_eq!(full, time(&["--torque-share", "1.0"]));
    // Without friction the time would grow as 1/√0.7 = 1.195.
    assert!((1.15..1.25).contains(&(time(&["--torque-share", "0.7"]) / full)));
    assert!((1.01..1.1).contains(&(time(&["--jerk", "1e5"]) / full)));
    let out = folder.path().join("out");
    time(&["--out", out.to_str().unwrap()]);
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("maximum velocity curve") && !page.contains("src=\"http"));
    assert!(refusal(&["--path", path, "--torque-share", "1.5"], 2).contains("1 at most"));
    assert!(refusal(&["--path", path, "--jerk", "0"], 2).contains("positive"));
}

#[test]
fn a_path_file_that_is_not_valid_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |key: &str, value: Value| {
        let mut case = line();
        case[key] = value;
        let path = written(folder.path(), &case);
        refusal(
            &["--robot", "benchtop", "--path", path.to_str().unwrap()],
            1,
        )
    };
    assert!(refused("corners", json!("round")).contains("round"));
    assert!(refused("working_mode", json!(["up", "left"])).contains("up"));
    assert!(refused("limits", json!({ "torque": [0.7, 0.7], "jerk": 3.0 })).contains("jerk"));
    assert!(refused("limits", json!({ "torque": [0.7, -0.7] })).contains("positive"));
    assert!(refused("path", json!([])).contains("no piece"));
    let far = json!([{ "kind": "line", "from": [0.04, 0.15], "to": [0.04, 0.5] }]);
    assert!(refused("path", far).contains("farther from A"));
    assert!(refused("payload", json!(-1.0)).contains("payload"));
    let message = refusal(&["--robot", "benchtop", "--path", "no-such-file.json"], 1);
    assert!(message.contains("no-such-file.json"));
}

#[test]
fn a_crossing_has_every_key_and_takes_negative_coordinates_in_both_ways() {
    let robot = shipped("robots/short_couplers.toml");
    let crossing = |from: &[&str], to: &[&str]| {
        let args = [
            &["--robot", &robot, "--crossing"],
            from,
            to,
            &["--time", "0.3"],
        ]
        .concat();
        answer(&args)
    };
    let found = crossing(&["--from", "0.06,0.115"], &["--to", "0.03,0.012"]);
    for (key, length) in [("N", 2), ("polynomial_in_t_over_tf", 9), ("peak_torque", 2)] {
        assert_eq!(found[key].as_array().unwrap().len(), length);
    }
    for key in ["tc", "s_c", "s_dot_c", "s_ddot_c", "f0"] {
        assert!(found[key].is_f64(), "{key}");
    }
    assert!(found["condition"].as_f64().unwrap().abs() < 1e-9);
    assert_eq!(found["assembly"], json!(["left", "right"]));
    // The singularity is at y ≈ 0.06 m; this line ends left of A.
    let args = [
        "--robot",
        &robot,
        "--crossing",
        "--time",
        "0.3",
        "--from",
        "0.02,0.11",
    ];
    let spaced = plan(&[&args[..], &["--to", "-0.002,0.02"]].concat());
    let joined = plan(&[&args[..], &["--to=-0.002,0.02"]].concat());
    assert_eq!(spaced, joined);
    assert_ne!(spaced.status.code(), Some(2));
}

#[test]
fn a_crossing_tells_whether_the_controller_accepts_it_and_answers_in_any_case() {
    let robot = shipped("robots/short_couplers.toml");
    let ends = ["--from", "0.06,0.115", "--to", "0.03,0.012"];
    let crossing = |time: &'static str| {
        [
            &["--crossing", "--robot", &robot, "--time", time],
            &ends[..],
        ]
        .concat()
    };
    let text = |time| {
        let output = plan(&crossing(time));
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    assert_eq!(
        answer(&crossing("0.3"))["controller"],
        json!({ "accepts": true })
    );
    assert!(text("0.3").contains("the controller accepts it"));
    let slow = answer(&crossing("1.0"));
    assert_eq!(slow["controller"]["accepts"], false);
    let reason = slow["controller"]["reason"].as_str().unwrap();
    assert!(reason.contains("cross in less time") && slow["tc"].is_f64());
    assert!(text("1.0").contains(&format!("the controller refuses it: {reason}")));
}

#[test]
fn a_crossing_needs_its_robot_s_permission_and_its_three_values() {
    let ends = ["--crossing", "--from", "0.06,0.115", "--to", "0.03,0.012"];
    let message = refusal(
        &[&ends[..], &["--robot", "benchtop", "--time", "0.3"]].concat(),
        1,
    );
    assert!(message.contains("allowed = true"));
    assert!(refusal(&ends, 2).contains("--time"));
    let allowed = shipped("robots/short_couplers.toml");
    let negative = [&ends[..], &["--robot", &allowed, "--time", "-1"]].concat();
    assert!(refusal(&negative, 1).contains("must be positive"));
    let nowhere = ["--crossing", "--from", "0.06,0.115", "--to", "0.06,0.115"];
    let nowhere = [&nowhere[..], &["--robot", &allowed, "--time", "0.3"]].concat();
    assert!(refusal(&nowhere, 1).contains("ends where it begins"));
    let jerk = ["--path", "path.json", "--jerk", "-1"];
    assert!(!refusal(&jerk, 2).contains("unexpected argument"));
    assert!(refusal(&[], 2).contains("--path"));
}
