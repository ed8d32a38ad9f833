//! The command `fivebar design`: its answer, the robot file that it writes, and its errors.

use fivebar_files::robot::Robot;
use fivebar_testkit::program;
use serde_json::Value;
use std::path::Path;
use std::process::{Output, Stdio};

const DESIGNS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/designs");

fn fivebar(args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.args(args).stdin(Stdio::null()).output().unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[track_caller]
fn answer(args: &[&str]) -> Value {
    let output = fivebar(args);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_leg_has_the_known_ring_and_its_front_more_dexterity() {
    let leg = format!("{DESIGNS}/leg.toml");
    let found = answer(&["design", &leg, "--json"]);
    let best = &found["best"];
    let size = number(&best["size"]);
    assert!((size / (0.3 * 0.8178) - 1.0).abs() < 1e-3, "{best}");
    assert_eq!(best["link_lengths"][4], 0.0);
    assert_eq!(best["link_lengths"][0], best["link_lengths"][3]);
    assert!((number(&best["link_sum"]) - 0.3).abs() < 1e-9);
    assert!((number(&best["dexterity"]) - 0.5).abs() < 1e-6);
    assert!(number(&best["place"][1]) > 0.0);
    assert_eq!(found["proved"], true);
    assert!(number(&found["evaluations"]) > 1000.0);
    let front = found["front"].as_array().unwrap();
    assert_eq!(front.len(), 3);
    assert_eq!(&front[0], best);
    for pair in front.windows(2) {
        assert!(number(&pair[1]["dexterity"]) > number(&pair[0]["dexterity"]));
        assert!(number(&pair[1]["size"]) < number(&pair[0]["size"]));
    }
}

#[test]
fn the_robot_file_has_whole_millimetres_and_every_command_takes_it() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let plotter = format!("{DESIGNS}/plotter.toml");
    let output = fivebar(&["design", &plotter, "--out", out]);
    assert!(output.status.success(), "{output:?}");
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(
        table.contains("stock") && table.contains("proved"),
        "{table}"
    );
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("<polyline") && page.contains("proved free of singularities"));
    let file = folder.path().join("best.toml");
    let file = file.to_str().unwrap();
    for length in Robot::load(file).unwrap().geometry.lengths() {
        assert!(
            (1e3 * length - (1e3 * length).round()).abs() < 1e-9,
            "{length} m"
        );
    }
    std::fs::write(folder.path().join("line.gcode"), "G1 X5 F6000\n").unwrap();
    for command in [
        &["query", "--robot", file][..],
        &["margins", file],
        &["sim", "line.gcode", "--robot", file],
    ] {
        let output = program(env!("CARGO_BIN_EXE_fivebar"))
            .args(command)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command:?}: {message}");
    }
}

#[test]
fn a_wrong_specification_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("spec.toml");
    let leg = std::fs::read_to_string(Path::new(DESIGNS).join("leg.toml")).unwrap();
    for (from, to, reason) in [
        (
            "dexterity = 0.5",
            "dexterity = 1.5",
            "line 10: `dexterity` of [require]",
        ),
        ("base = [0.0, 0.0]", "base = [0.1, 0.0]", "line 3: `base`"),
        ("link_sum = 0.3", "", "`link_sum` is missing"),
        ("\"annulus\"", "\"ring\"", "annulus"),
    ] {
        std::fs::write(&file, leg.replace(from, to)).unwrap();
        let output = fivebar(&["design", file.to_str().unwrap(), "--json"]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(
            message.contains(reason) && message.contains("spec.toml"),
            "{message}"
        );
    }
}

#[test]
fn each_arm_of_the_front_is_a_robot_file_and_is_drawn_on_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let leg = format!("{DESIGNS}/leg.toml");
    let output = fivebar(&["design", &leg, "--json", "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let front = answer["front"].as_array().unwrap();
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    for (index, design) in front.iter().enumerate().skip(1) {
        let file = out.join(format!("front-{}.toml", index + 1));
        let robot = Robot::load(file.to_str().unwrap()).unwrap();
        for (found, length) in robot
            .geometry
            .lengths()
            .into_iter()
            .zip(design["link_lengths"].as_array().unwrap())
        {
            assert!((found - number(length)).abs() < 1e-9, "{design}");
        }
        assert!(page.contains(&format!("front {}", index + 1)));
    }
    assert_eq!(
        page.matches("<polyline").count(),
        3 * (front.len() + 1),
        "two rims and an arm each"
    );
}

#[test]
fn the_least_error_is_sought_under_stated_tolerances_only() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("spec.toml");
    let precise = std::fs::read_to_string(format!("{DESIGNS}/precise.toml")).unwrap();
    let (start, rest) = precise.split_once("[tolerance]").unwrap();
    let spec = format!(
        "{start}[objective]{}",
        rest.split_once("[objective]").unwrap().1
    );
    std::fs::write(&file, spec).unwrap();
    let output = fivebar(&["design", file.to_str().unwrap(), "--json"]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("spec.toml, line 15") && message.contains("[tolerance]"),
        "{message}"
    );
    std::fs::write(&file, precise).unwrap();
    let output = fivebar(&["design", file.to_str().unwrap(), "--json"]);
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let error = number(&answer["best"]["error"]);
    // The library's own tests compare the error of each arm with the analysis of its accuracy.
    assert!((error - 91.2e-6).abs() < 0.5e-6, "{error}");
    assert_eq!(answer["proved"], true);
}
