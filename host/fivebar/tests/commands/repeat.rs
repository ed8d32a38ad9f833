//! `fivebar sim --repeat`: runs in the summary, and what was learnt in a file that belongs to one robot and one job.

use fivebar_testkit::program;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;

fn sim(folder: &Path, args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.current_dir(folder).args(["sim", "wrong.toml"]);
    command.args(args).output().unwrap()
}

fn summary(output: &Output) -> Value {
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn sensed(summary: &Value) -> Vec<f64> {
    let runs = summary["runs"].as_array().unwrap();
    let rms = |run: &Value| run["sensed"]["rms_m"].as_f64().unwrap();
    runs.iter().map(rms).collect()
}

#[test]
fn runs_are_learnt_kept_and_forgotten() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("job.gcode", "G21 G90\nG1 X15 Y0 F6000\nX15 Y8\nX0 Y0\n");
    let scenario = "robot = \"benchtop\"\njob = \"job.gcode\"\n[mismatch]\nfriction = 0.5\ncogging = [3e-3, 3e-3]\n";
    write("wrong.toml", scenario);

    let found = summary(&sim(folder, &["--repeat", "3", "--json"]));
    let runs = sensed(&found);
    assert_eq!(runs.len(), 3);
    for key in ["rms_m", "max_m"] {
        assert!(found["runs"][2][key].as_f64().unwrap() > 0.0, "{key}");
    }
    let same = found["repeats_m"][0].as_f64().unwrap();
    assert!(same > 0.8 * runs[0] && found["learning"].is_null());
    assert_eq!(found["pid_runs"].as_array().unwrap().len(), 3);

    let learn = ["--repeat", "3", "--learn", "--json"];
    let found = summary(&sim(folder, &learn));
    let runs = sensed(&found);
    assert!(runs[2] < 0.75 * runs[0], "{runs:?}");
    let learning = &found["learning"];
    assert!(learning["contraction"].as_f64().unwrap() <= 0.9);
    assert!(learning["undone"].is_null() && learning["forgotten"].is_null());
    assert!(folder.join("out/sim/learnt.json").exists());

    // The next command goes on from there, and its text says what each run gave.
    let output = sim(folder, &["--repeat", "2", "--learn"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success());
    for words in [
        "run 2",
        "by the sensors",
        "learning    shifts of up to",
        "not learnt",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let again = fs::read_to_string(folder.join("out/sim/summary.json")).unwrap();
    let again = sensed(&serde_json::from_str(&again).unwrap());
    assert!(again[0] < 1.15 * runs[2], "{again:?} after {runs:?}");

    // Another payload: what was learnt is forgotten, and that is said.
    let benchtop = include_str!("../../../files/robots/benchtop.toml");
    write(
        "loaded.toml",
        &benchtop.replacen("payload = 0.03", "payload = 0.06", 1),
    );
    let output = sim(
        folder,
        &[
            "--repeat",
            "2",
            "--learn",
            "--robot",
            "loaded.toml",
            "--json",
        ],
    );
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        error.contains("is forgotten: the robot, its payload"),
        "{error}"
    );
    let found = summary(&output);
    assert!(
        found["learning"]["forgotten"]
            .as_str()
            .unwrap()
            .starts_with("the robot")
    );

    let output = sim(folder, &["--learn"]);
    assert_eq!(output.status.code(), Some(2));
}
