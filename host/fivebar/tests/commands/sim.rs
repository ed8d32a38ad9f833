//! The command `fivebar sim`: its accuracy, output, files and errors.

use crate::bench::Bench;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

const PETAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/petal.gcode");
const SCENARIOS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/scenarios");

impl Bench {
    /// Asserts that the command is refused with `status` and a message that contains these
    /// words, and that it writes nothing.
    #[track_caller]
    fn assert_refused(&self, arguments: &[&str], status: i32, words: &[&str]) {
        let output = self.sim(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{message}");
        for word in words {
            assert!(message.contains(word), "`{word}` is missing in: {message}");
        }
        assert!(output.stdout.is_empty());
        assert!(!self.path("out").exists(), "half-written output");
    }
}

fn json(output: &Output) -> Value {
    let stdout = std::str::from_utf8(&output.stdout).unwrap();
    serde_json::from_str(stdout.lines().last().unwrap()).unwrap()
}

#[test]
fn the_tip_error_is_below_3_5_micrometres_and_below_that_of_pid_with_feed_forward() {
    let bench = Bench::new();
    let output = bench.sim(&[PETAL, "--out", "deep/out", "--json"]);
    assert!(output.status.success(), "{output:?}");
    let summary = json(&output);
    let rms = summary["tip_error"]["rms_m"].as_f64().unwrap();
    let pid = summary["pid_tip_error"]["rms_m"].as_f64().unwrap();
    assert!(rms <= 3.5e-6, "{rms} m");
    assert!(pid >= 1.1 * rms, "PID {pid} m, computed torque {rms} m");
    assert!(summary["tip_error"]["max_m"].as_f64().unwrap() >= rms);
    let placed = summary["tip_error_placed"]["rms_m"].as_f64().unwrap();
    assert!((0.3 * rms..1.01 * rms).contains(&placed), "{placed} m");
    assert_eq!(summary["robot"], "benchtop");
    assert_eq!(summary["scenario"], "petal");
    assert_eq!(summary["faults"], serde_json::json!([]));
    assert_eq!(summary["out_dir"], "deep/out");
    let ticks = summary["ticks"].as_u64().unwrap();
    let simulated = summary["simulated_s"].as_f64().unwrap();
    assert!((simulated - 1e-4 * ticks as f64).abs() < 1e-9);
    assert!(summary["wall_s"].as_f64().unwrap() > 0.0);
    assert!(summary["saturated_ticks"].is_u64());
    for torque in summary["peak_torque_nm"].as_array().unwrap() {
        assert!((0.01..0.75).contains(&torque.as_f64().unwrap()));
    }
    let written = |name: &str| std::fs::read_to_string(bench.path("deep/out").join(name)).unwrap();
    let saved: Value = serde_json::from_str(&written("summary.json")).unwrap();
    assert_eq!(saved, summary);
    assert!(written("report.html").contains("PID with feed-forward"));
    assert!(written("trace.csv").lines().count() > 1000);
}

#[test]
fn without_a_job_the_demonstration_is_drawn() {
    let bench = Bench::new();
    let output = bench.sim(&["--robot", "usp_2dof", "--json"]);
    assert!(output.status.success(), "{output:?}");
    let summary = json(&output);
    assert_eq!(summary["robot"], "usp_2dof");
    assert_eq!(summary["scenario"], "the demonstration");
    assert!(bench.path("out/sim/report.html").exists());
}

/// Tools far from C [m], and the scale that is told of the demonstration.
const FAR: [([f64; 2], Option<&str>); 3] = [
    ([-0.16, -0.1], Some("0.5")),
    ([-0.1, 0.15], Some("0.5")),
    ([0.1, -0.1], None),
];

#[test]
fn with_a_tool_far_from_c_the_demonstration_is_drawn_at_the_greatest_scale() {
    drawn_with_tools(&FAR[..1]);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_tools_far_from_c_with_which_the_demonstration_is_drawn() {
    drawn_with_tools(&FAR);
}

fn drawn_with_tools(tools: &[([f64; 2], Option<&str>)]) {
    let bench = Bench::new();
    let benchtop = include_str!("../../../files/robots/benchtop.toml");
    for &(offset, scale) in tools {
        let text = format!("{benchtop}\n[tool]\noffset = {offset:?}\n");
        let robot = bench.file("offset.toml", &text);
        let output = bench.sim(&["--robot", &robot, "--json"]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{offset:?}: {message}");
        assert_eq!(
            message
                .trim()
                .split_once("at a scale of ")
                .map(|(_, scale)| scale),
            scale,
            "{offset:?}"
        );
        let rms = json(&output)["tip_error"]["rms_m"].as_f64().unwrap();
        assert!(rms <= 50e-6, "{offset:?}: {rms} m");
    }
    // A scale that is given is not changed.
    let offset = format!("{benchtop}\n[tool]\noffset = [-0.16, -0.1]\n");
    let robot = bench.file("offset.toml", &offset);
    let output = bench.sim(&["--robot", &robot, "--scale", "1"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
}

#[test]
fn a_job_that_takes_too_long_is_refused() {
    let bench = Bench::new();
    let job = bench.file("slow.gcode", "G0 X0 Y0\nG1 X6 Y5 F0.0001\n");
    bench.assert_refused(&[&job], 1, &["slow.gcode, line 2", "longer than 86400 s"]);
}

#[test]
fn a_seed_gives_the_same_run_again() {
    let bench = Bench::new();
    let run = |out| {
        assert!(bench.sim(&[PETAL, "--out", out]).status.success());
        std::fs::read(bench.path(out).join("trace.csv")).unwrap()
    };
    assert_eq!(run("one"), run("two"));
}

#[test]
fn a_job_out_of_reach_is_refused_with_line_and_point() {
    let bench = Bench::new();
    let words = ["petal.gcode, line 5", "--scale"];
    bench.assert_refused(&[PETAL, "--scale", "20"], 1, &words);
    let words = ["petal.gcode, line 3", "at ("];
    bench.assert_refused(&[PETAL, "--origin", "0.04,0.30"], 1, &words);
}

#[test]
fn a_refused_job_leaves_an_older_report_unchanged() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("kept")).unwrap();
    std::fs::write(bench.path("kept/report.html"), "older").unwrap();
    bench.assert_refused(&[PETAL, "--scale", "20", "--out", "kept"], 1, &["line"]);
    let files: Vec<_> = std::fs::read_dir(bench.path("kept")).unwrap().collect();
    assert_eq!(files.len(), 1);
    assert_eq!(
        std::fs::read_to_string(bench.path("kept/report.html")).unwrap(),
        "older"
    );
}

#[test]
fn a_folder_that_cannot_be_written_is_refused_before_the_run() {
    let bench = Bench::new();
    bench.file("taken", "");
    bench.assert_refused(&[PETAL, "--out", "taken/out"], 1, &["taken/out", "--out"]);
}

/// `./ci.sh package` also checks it: there the program is built without the feature.
#[cfg(not(feature = "mcap"))]
#[test]
fn a_log_is_refused_before_the_run_by_a_program_without_mcap() {
    let bench = Bench::new();
    bench.assert_refused(&[PETAL, "--log", "run.mcap"], 1, &["--features mcap"]);
}

#[cfg(feature = "mcap")]
#[test]
fn a_log_that_cannot_be_written_is_refused_before_the_run() {
    let bench = Bench::new();
    bench.file("taken", "");
    let log = ["--log", "taken/run.mcap"];
    bench.assert_refused(&[&[PETAL], &log[..]].concat(), 1, &["taken", "--log"]);
    std::fs::create_dir(bench.path("logs")).unwrap();
    bench.assert_refused(&[PETAL, "--log", "logs"], 1, &["logs is a folder"]);
}

#[test]
fn invalid_jobs_are_refused_with_their_line() {
    let bench = Bench::new();
    for (text, words) in [
        ("", ["job.gcode", "an empty file"]),
        ("G21\nM3\nM5\n", ["job.gcode", "no motion"]),
        ("G21\nG1 X10 F600\nG38.2 X0\n", ["line 3", "G38.2"]),
        ("G21\nG1 Xnan Y0 F600\n", ["line 2", "job.gcode"]),
        ("G21\nG1 X1e999 Y0 F600\n", ["line 2", "job.gcode"]),
        ("G21\nG1 X10 Y0 F0\n", ["line 2", "feed rate"]),
        ("\u{0}\u{1}\u{2}", ["job.gcode", "line 1"]),
    ] {
        let job = bench.file("job.gcode", text);
        bench.assert_refused(&[&job, "--origin", "0.04,0.16"], 1, &words);
    }
    bench.assert_refused(&["missing.gcode"], 1, &["missing.gcode"]);
}

#[test]
fn a_line_across_a_singularity_is_refused_with_its_position() {
    let bench = Bench::new();
    // Behind the base the elbows would have to be on the other side.
    let job = bench.file("job.gcode", "G21 G90 F3000\nG0 X40 Y160\nG1 X40 Y-160\n");
    bench.assert_refused(&[&job, "--origin", "0,0"], 1, &["line 3", "at ("]);
}

#[test]
fn robots_that_cannot_be_simulated_are_refused() {
    let bench = Bench::new();
    bench.assert_refused(&[PETAL, "--robot", "haply"], 1, &["haply", "lengths only"]);
    bench.assert_refused(&[PETAL, "--robot", "nosuch"], 1, &["nosuch", "benchtop"]);
    let benchtop = include_str!("../../../files/robots/benchtop.toml");
    let long = bench.file("long.toml", &benchtop.replace("base = 0.08", "base = 8.0"));
    bench.assert_refused(
        &[PETAL, "--robot", &long],
        1,
        &["long.toml, line", "assembled"],
    );
    let wrong = bench.file("wrong.toml", &benchtop.replace("payload =", "paylod ="));
    bench.assert_refused(
        &[PETAL, "--robot", &wrong],
        1,
        &["wrong.toml, line", "paylod"],
    );
    let fast = bench.file(
        "fast.toml",
        &benchtop.replace("[protection]", "[control]\nbandwidth = 9e9\n[protection]"),
    );
    let words = ["fast.toml, line", "`bandwidth` of [control]"];
    bench.assert_refused(&[PETAL, "--robot", &fast], 1, &words);
}

#[test]
fn for_an_arm_that_falls_while_unpowered_the_brake_torque_is_stated() {
    let bench = Bench::new();
    let benchtop = include_str!("../../../files/robots/benchtop.toml");
    let upright = benchtop.replace("gravity = [0.0, 0.0]", "gravity = [0.0, -9.81]");
    let upright = bench.file("upright.toml", &upright);
    let run = bench.sim(&[PETAL, "--robot", &upright]);
    assert_eq!(run.status.code(), Some(1));
    let message = String::from_utf8(run.stderr).unwrap();
    for words in [
        "following error. Unpowered it falls",
        "`brake_torque` of this joint is 0 N·m",
    ] {
        assert!(
            message.contains(words),
            "`{words}` is missing in: {message}"
        );
    }
}

#[test]
fn invalid_command_lines_exit_with_2() {
    let bench = Bench::new();
    for arguments in [
        &[PETAL, "--origin", "0.1"][..],
        &[PETAL, "--origin", "nan,0"],
        &[PETAL, "--scale", "-1"],
        &[PETAL, "--scale", "inf"],
        &[PETAL, "--sclae", "2"],
    ] {
        bench.assert_refused(arguments, 2, &["error"]);
    }
}

#[test]
fn a_robot_file_given_as_scenario_is_refused_with_the_right_option() {
    let bench = Bench::new();
    let robot = fivebar_files::robot::BUILT_IN[0].text;
    let file = bench.file("arm.toml", robot);
    bench.assert_refused(&[&file], 1, &["this is a robot", "--robot"]);
    let file = bench.file("broken.toml", &robot.replace("base =", "bse ="));
    bench.assert_refused(&[&file], 1, &["line", "unknown field"]);
}

#[test]
fn invalid_scenario_files_are_refused_with_their_line() {
    let bench = Bench::new();
    let job = format!("job = '{PETAL}'\n");
    for (text, words) in [
        ("seed = 3\n".to_owned(), ["line 1", "missing field `job`"]),
        (
            format!("{job}speed = 3\n"),
            ["line 2", "unknown field `speed`"],
        ),
        (format!("{job}scale = nan\n"), ["line 2", "`scale`"]),
        (format!("{job}seed = -1\n"), ["line 2", "invalid value"]),
        (
            format!("{job}[mismatch]\nfriction = -2\n"),
            ["line 3", "`friction`"],
        ),
        (
            format!("{job}[mismatch]\nfiction = 0.1\n"),
            ["line 3", "unknown field `fiction`"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'sabotage'\n"),
            ["line 3", "sabotage"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'encoder_dead'\n"),
            ["line 2", "`joint`"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'encoder_dead'\njoint = 2\n"),
            ["line 4", "1 or 4, not 2"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'ticks_missed'\nticks = 0\n"),
            ["line 4", "1 to 10000, not 0"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'belt_breaks'\njoint = 1\n"),
            ["line 3", "`stiffness`"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'brake_stuck'\njoint = 1\n"),
            ["line 3", "`brake_torque`"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'brake_late'\njoint = 1\nseconds = -1\n"),
            ["line 5", "0.0 to 10.0, not -1.0"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'coupling_slips'\njoint = 1\nshare = 1.0\n"),
            ["line 5", "0.0 to 0.99, not 1.0"],
        ),
        (
            format!("{job}[[fault]]\nkind = 'payload_changes'\nkilograms = -0.04\n"),
            ["line 4", "more than the payload"],
        ),
        (
            format!("job = '{PETAL}.nosuch'\n"),
            ["petal.gcode.nosuch", "cannot read"],
        ),
    ] {
        let file = bench.file("run.toml", &text);
        bench.assert_refused(&[&file], 1, &words);
    }
}

/// The built-in scenarios, and the fault with which each ends.
const ENDS: [(&str, Option<&str>); 9] = [
    ("no_mismatch", None),
    ("switch_missing", Some("envelope")),
    ("realistic", None),
    ("bus_sags", Some("under voltage")),
    ("emergency_stop", Some("emergency stop")),
    ("encoder_dies", Some("encoder stuck")),
    ("late_ticks", Some("tick overrun")),
    ("motor_stalls", Some("following error")),
    ("sensor_drifts", None),
];

#[test]
fn built_in_scenarios_end_as_described() {
    end_as_described(&ENDS[..2]);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_built_in_scenarios_that_end_as_described() {
    end_as_described(&ENDS);
}

fn end_as_described(scenarios: &[(&str, Option<&str>)]) {
    let bench = Bench::new();
    for &(name, fault) in scenarios {
        let file = Path::new(SCENARIOS).join(name).with_extension("toml");
        let output = bench.sim(&[file.to_str().unwrap(), "--out", name, "--json"]);
        let summary = json(&output);
        let expected: Vec<_> = fault.into_iter().collect();
        assert_eq!(summary["faults"], serde_json::json!(expected), "{name}");
        assert_eq!(summary["scenario"], name);
        assert_eq!(
            output.status.code(),
            Some(i32::from(fault.is_some())),
            "{name}"
        );
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.contains(fault.unwrap_or_default()), "{message}");
        assert!(bench.path(name).join("report.html").exists());
    }
}

/// Belts that the robot file does not declare, as soft as they are on printers.
#[test]
fn an_arm_on_undeclared_belts_ends_with_the_fault_of_a_loop_that_oscillates() {
    let bench = Bench::new();
    for (stiffness, faults) in [
        (700.0, &["oscillation"][..]),
        (1250.0, &["oscillation"]),
        (20_000.0, &[]),
    ] {
        let run = format!(
            "job = {PETAL:?}\n[mismatch]\nstiffness = [{stiffness:?}, {stiffness:?}]\n\
             drive_damping = [0.03, 0.03]\n"
        );
        let file = bench.file("belt.toml", &run);
        let output = bench.sim(&[&file, "--json"]);
        let figures: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(
            figures["faults"],
            serde_json::json!(faults),
            "{stiffness} N·m/rad"
        );
    }
}

#[test]
fn a_run_that_ends_early_by_a_fault_has_no_comparison_with_pd() {
    let bench = Bench::new();
    for (name, is_begun) in [("encoder_dies", true), ("switch_missing", false)] {
        let file = Path::new(SCENARIOS).join(name).with_extension("toml");
        let output = bench.sim(&[file.to_str().unwrap(), "--out", name]);
        let printed = String::from_utf8(output.stdout).unwrap();
        assert_eq!(printed.contains("tip error"), is_begun, "{printed}");
        assert!(!printed.contains("×"), "{printed}");
        let report = std::fs::read_to_string(bench.path(name).join("report.html")).unwrap();
        assert!(!report.contains("NaN"), "{name}");
        assert_eq!(report.contains("had not begun"), !is_begun, "{name}");
    }
}
