//! Whether the simulated arm drew its job: keys, exit status, the reason, and the report.

use crate::bench::Bench;
use fivebar_files::robot::BuiltIn;
use serde_json::Value;
use std::process::Output;

const PETAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/petal.gcode");

fn json(output: &Output) -> Value {
    let stdout = std::str::from_utf8(&output.stdout).unwrap();
    serde_json::from_str(stdout.lines().last().unwrap()).unwrap()
}

impl Bench {
    /// The petal with a robot that has a fault from `at` [s] on.
    fn faulted(&self, robot: &str, at: f64, kind: &str) -> String {
        let text =
            format!("job = {PETAL:?}\nrobot = {robot:?}\n[[fault]]\nat = {at:?}\nkind = {kind}\n");
        self.file("faulted.toml", &text)
    }
}

const STALLED: &str = "\"motor_stalled\"\njoint = 4";

/// Steppers and hobby servos have no encoders: no fault is raised.
#[test]
fn a_wrong_drawing_without_a_fault_has_exit_status_1_and_its_reason_on_one_line() {
    let bench = Bench::new();
    let open = "\"motor_disconnected\"\njoint = 4";
    let lost = "\"step_lost\"\njoint = 1\nsteps = 20";
    for (robot, at, kind, tolerance, part) in [
        (
            "benchtop_stepper",
            0.4,
            STALLED,
            1e-3..1.001e-3,
            "full steps",
        ),
        ("benchtop_stepper", 0.4, open, 1e-3..1.001e-3, "full steps"),
        (
            "benchtop_stepper",
            0.1,
            lost,
            1e-3..1.001e-3,
            "20 and 0 full steps",
        ),
        ("classroom_servo", 1.0, STALLED, 2e-3..3e-3, "mm"),
    ] {
        let scenario = bench.faulted(robot, at, kind);
        let output = bench.sim(&[&scenario, "--json"]);
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let found = json(&output);
        assert_eq!(found["faults"], serde_json::json!([]));
        assert_eq!(found["drawn"], false);
        assert!(found["worst_m"].as_f64().unwrap() > 5e-3, "{found}");
        assert!(
            tolerance.contains(&found["tolerance_m"].as_f64().unwrap()),
            "{found}"
        );
        let why = found["why"].as_str().unwrap();
        assert!(
            why.contains("petal.gcode, line ") && why.contains(part),
            "{why}"
        );
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(message.lines().last(), Some(&*format!("fivebar: {why}")));
        let written = |name: &str| std::fs::read_to_string(bench.path("out/sim").join(name));
        let saved: Value = serde_json::from_str(&written("summary.json").unwrap()).unwrap();
        assert_eq!(saved, found);
        let page = written("report.html").unwrap();
        let (_, body) = page.split_once("</h1>").unwrap();
        assert!(
            body.trim_start()
                .starts_with("<p class=\"failure\">Not drawn. "),
            "{robot}"
        );
    }
}

/// The same job on drivers that give a current is drawn.
#[test]
fn steppers_on_drivers_that_give_a_voltage_are_warned_of_before_the_run_and_late_in_it() {
    let bench = Bench::new();
    let current = BuiltIn::find("benchtop_stepper").unwrap().text;
    let kind = "kind = \"stepper\"";
    let voltage = current.replace(kind, &format!("{kind}\ndriver = \"voltage\""));
    let [current, voltage] = [("current.toml", current), ("voltage.toml", &*voltage)].map(|it| {
        let robot = bench.file(it.0, it.1);
        bench.sim(&[PETAL, "--robot", &robot, "--json"])
    });
    let warning = |output: &Output| {
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let is_told = text.contains("`driver = \"voltage\"`") && text.contains("SPREAD");
        (is_told, text)
    };
    assert!(current.status.success() && !warning(&current).0);
    assert!(warning(&voltage).0, "{}", warning(&voltage).1);
    let worst = [&current, &voltage].map(|output| json(output)["worst_m"].as_f64().unwrap());
    let lost = json(&voltage)["lost_steps"].clone();
    println!("worst {worst:?} m, lost steps {lost}");
    // It is late by the lag of its fields, and slow enough to lose no step.
    assert!(worst[1] > 1.5 * worst[0], "{worst:?}");
    assert_eq!(lost, serde_json::json!([0, 0]));
    // Whoever commands an arm on a port is warned as well.
    for command in [&["drive", PETAL][..], &["bridge"], &["serve"]] {
        for (robot, is_warned) in [("current.toml", false), ("voltage.toml", true)] {
            let port = ["--robot", robot, "--port", "/dev/nothing"];
            let output = bench.run(&[command, &port].concat());
            assert_eq!(output.status.code(), Some(1), "{command:?}");
            let (is_told, text) = warning(&output);
            assert!(text.contains("there is no port"), "{command:?}: {text}");
            assert_eq!(is_told, is_warned, "{command:?}: {text}");
        }
    }
}

#[test]
fn the_tolerance_decides_and_is_a_length() {
    let bench = Bench::new();
    let output = bench.sim(&[PETAL, "--json"]);
    assert!(output.status.success(), "{output:?}");
    let found = json(&output);
    assert_eq!(
        (&found["drawn"], &found["why"]),
        (&true.into(), &Value::Null)
    );
    assert_eq!(found["tolerance_m"], 1e-3);
    let worst = found["worst_m"].as_f64().unwrap();
    assert!(worst > 0.0 && worst <= found["tip_error"]["max_m"].as_f64().unwrap());
    let page = std::fs::read_to_string(bench.path("out/sim/report.html")).unwrap();
    let (_, body) = page.split_once("</h1>").unwrap();
    assert!(body.trim_start().starts_with("<p>Drawn: the tip was "));

    for (tolerance, status) in [(0.99 * worst, 1), (1.01 * worst, 0)] {
        let output = bench.sim(&[PETAL, "--tolerance", &format!("{}um", 1e6 * tolerance)]);
        assert_eq!(output.status.code(), Some(status), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        let word = if status == 0 { "yes" } else { "no" };
        assert!(text.contains(&format!("  drawn       {word}: ")), "{text}");
    }
    let stalled = bench.faulted("benchtop_stepper", 0.4, STALLED);
    let output = bench.sim(&[&stalled, "--tolerance", "5cm"]);
    assert!(output.status.success(), "{output:?}");
    for wrong in ["0", "-1mm", "much"] {
        let output = bench.sim(&[PETAL, "--tolerance", wrong]);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
    }
}

#[test]
fn a_repeated_job_is_drawn_only_if_every_run_is() {
    let bench = Bench::new();
    let repeated = |scenario: &str, more: &[&str]| {
        let output = bench.sim(&[&[scenario, "--repeat", "2", "--json"], more].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), json(&output), message)
    };
    let (status, found, message) = repeated(PETAL, &[]);
    assert_eq!(
        (status, &found["drawn"]),
        (Some(0), &true.into()),
        "{message}"
    );
    let runs = |found: &Value| -> Vec<bool> {
        let runs = found["runs"].as_array().unwrap().iter();
        runs.map(|run| run["drawn"].as_bool().unwrap()).collect()
    };
    assert_eq!(runs(&found), [true, true]);
    let (status, found, message) = repeated(PETAL, &["--tolerance", "1um"]);
    assert_eq!((status, runs(&found)), (Some(1), vec![false, false]));
    let why = found["why"].as_str().unwrap();
    assert!(
        why.starts_with("run 1: ") && message.ends_with(&format!("fivebar: {why}\n")),
        "{why}"
    );
    // A fault ends the runs.
    let stalled = bench.faulted("benchtop", 0.4, STALLED);
    let (status, found, _) = repeated(&stalled, &[]);
    assert_eq!((status, runs(&found)), (Some(1), vec![false]));
    assert!(
        found["why"].as_str().unwrap().contains("with fault 3"),
        "{found}"
    );
}
