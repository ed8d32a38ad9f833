//! The command `fivebar identify`: proposals, simulated logs, answers, files and refusals.

use crate::arms::text;
use fivebar_testkit::program;
use serde_json::Value;
use std::path::Path;
use std::process::Output;

fn identify(args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.arg("identify").args(args).output().unwrap()
}

fn answer(args: &[&str]) -> Value {
    let output = identify(&[args, &["--json"]].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn refusal(folder: &Path, text: &str) -> String {
    let (log, out) = (folder.join("bad.csv"), folder.join("never.toml"));
    std::fs::write(&log, text).unwrap();
    let output = identify(&[
        "--log",
        log.to_str().unwrap(),
        "--out",
        out.to_str().unwrap(),
    ]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(output.stdout.is_empty() && !out.exists());
    assert!(message.contains("bad.csv"), "{message}");
    message
}

#[test]
fn an_arm_is_excited_logged_identified_and_its_file_rewritten() {
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (
        folder.path().join("log.csv"),
        folder.path().join("arm.toml"),
    );
    let (log, out) = (log.to_str().unwrap(), out.to_str().unwrap());
    let proposed = answer(&["--robot", "benchtop", "--simulate", log]);
    assert_eq!(proposed["x"].as_array().unwrap().len(), 2);
    for trajectory in proposed["x"].as_array().unwrap() {
        assert_eq!(trajectory.as_array().unwrap().len(), 22);
    }
    assert!(proposed["period_s"].is_f64() && proposed["cost"].is_array());
    assert_eq!(answer(&["--propose"]), proposed);

    let found = answer(&["--robot", "benchtop", "--log", log, "--out", out]);
    let base = &found["base_parameters"];
    let names: Vec<&String> = base.as_object().unwrap().keys().collect();
    let mut wanted = ["J1", "J4", "J2", "J3", "h2x", "h2y", "h3y"];
    wanted.sort_unstable();
    assert_eq!(names, wanted);
    // The declared mismatch: links 10 % heavier, 20 g more payload, friction 30 % higher.
    for (key, wanted) in [
        ("J1", 1.557275e-3),
        ("J4", 6.172749e-4),
        ("J2", 2.3778e-3),
        ("h2x", 1.504e-2),
    ] {
        let error = base[key].as_f64().unwrap() / wanted - 1.0;
        assert!(error.abs() < 0.01, "{key}: {error}");
        assert!(found["base_parameters_sd"][key].as_f64().unwrap() > 0.0);
    }
    for key in ["viscous", "coulomb", "offset_nm", "torque_residual_rms_nm"] {
        assert_eq!(found[key].as_array().unwrap().len(), 2, "{key}");
    }
    for key in ["viscous_sd", "coulomb_sd", "offset_nm_sd"] {
        assert!(found[key][1].as_f64().unwrap() > 0.0, "{key}");
    }
    assert!(found["condition"].as_f64().unwrap() < 10.0);
    let robot = fivebar_files::robot::Robot::load(out).unwrap();
    // The masses of the new file have the base parameters that were found: J1* = J1 + l1² (m2 + K)
    // with the rotor and the payload, K = h3x/l3.
    let arm = robot.arm().unwrap();
    let [link1, link2, link3, _] = arm.links();
    let [l1, _, l3, ..] = robot.geometry.lengths();
    let own = link1.inertia + link1.mass * link1.com.norm_squared() + 6.4e-5;
    let beyond = link2.mass + arm.payload() + link3.mass * link3.com.x / l3;
    let error = (own + l1 * l1 * beyond) / base["J1"].as_f64().unwrap() - 1.0;
    assert!(error.abs() < 1e-4, "{error}");
    let [first, _] = robot.actuators.unwrap();
    assert!((first.coulomb_friction / 11.7e-3 - 1.0).abs() < 0.02);
    assert!(
        std::fs::read_to_string(out)
            .unwrap()
            .contains("by identification; before: 9e-3")
    );

    // A second trajectory, and the payload alone: the new file has what the arm carries.
    let second = folder.path().join("second.csv");
    let second = second.to_str().unwrap();
    answer(&["--simulate", second, "--second"]);
    let both = answer(&["--log", log, "--validate", second]);
    let share = |key: &str| both["validation"][key].as_f64().unwrap();
    assert!(share("error_share") < 0.01, "{both}");
    assert!(share("error_of_the_file_share") > 10.0 * share("error_share"));
    let carried = answer(&["--robot", out, "--log", second, "--payload"]);
    let payload = carried["payload_kg"].as_f64().unwrap();
    assert!((payload - arm.payload()).abs() < 1e-3, "{carried}");
    // The words; the figures are those of the whole second log.
    let rows = std::fs::read_to_string(second).unwrap();
    let short = folder.path().join("short.csv");
    let lines: Vec<&str> = rows.lines().take(20_000).collect();
    std::fs::write(&short, lines.join("\n")).unwrap();
    let short = short.to_str().unwrap();
    let text = String::from_utf8(identify(&["--log", log, "--validate", short]).stdout).unwrap();
    for wanted in [
        " kg·m² ± ",
        "Coulomb friction 11.7 mN·m ± ",
        "by the robot file to ",
    ] {
        assert!(text.contains(wanted), "{wanted} in {text}");
    }

    spoilt_logs_are_refused(folder.path(), log, second);
}

/// The log has torques in the place of currents. The simulated arm is that of the declared mismatch.
#[test]
fn arms_on_a_bus_are_excited_logged_identified_and_their_files_rewritten() {
    for arm in ["leg", "mit"] {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).display().to_string();
        let [file, log, second, out] = ["arm.toml", "log.csv", "second.csv", "out.toml"].map(path);
        std::fs::write(&file, text(arm)).unwrap();
        answer(&["--robot", &file, "--simulate", &log]);
        answer(&["--robot", &file, "--simulate", &second, "--second"]);
        let header = std::fs::read_to_string(&log).unwrap();
        assert!(header.starts_with("time_s,theta1_rad,theta4_rad,torque1_nm,torque4_nm\n"));
        let found = answer(&[
            "--robot",
            &file,
            "--log",
            &log,
            "--validate",
            &second,
            "--out",
            &out,
        ]);
        let share = |key: &str| found["validation"][key].as_f64().unwrap();
        assert!(share("error_share") < 0.03, "{arm}: {found}");
        assert!(
            share("error_of_the_file_share") > 4.0 * share("error_share"),
            "{arm}: {found}"
        );
        assert!(found["coverage_factor_95"].as_f64().unwrap() > 1.9, "{arm}");
        let robot = fivebar_files::robot::Robot::load(&out).unwrap();
        let [first, _] = robot.actuators.unwrap();
        assert!((first.coulomb_friction / 26e-3 - 1.0).abs() < 0.02, "{arm}");
        let carried = answer(&["--robot", &out, "--log", &second, "--payload"]);
        let payload = carried["payload_kg"].as_f64().unwrap();
        assert!(
            (payload - robot.arm().unwrap().payload()).abs() < 1e-3,
            "{carried}"
        );
    }
}

/// Logs that do not belong to the arm, made of two that do.
fn spoilt_logs_are_refused(folder: &Path, log: &str, second: &str) {
    // A second log that the first one does not predict.
    let spoilt = folder.join("spoilt.csv");
    let rows = std::fs::read_to_string(second).unwrap();
    std::fs::write(
        &spoilt,
        rows.replacen("current1_a,current4_a", "current4_a,current1_a", 1),
    )
    .unwrap();
    let never = folder.join("never.toml");
    let output = identify(&[
        "--log",
        log,
        "--validate",
        spoilt.to_str().unwrap(),
        "--out",
        never.to_str().unwrap(),
    ]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(
        message.contains("are not predicted by what the first log gave"),
        "{message}"
    );
    assert!(!never.exists());

    // The log again, spoilt in several ways.
    let text = std::fs::read_to_string(log).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let header = lines[0];
    let gap = [&lines[..9000], &lines[9050..20_000]].concat().join("\n");
    assert!(refusal(folder, &gap).contains("has a gap"));
    let every_second: Vec<&str> = lines[1..20_000].iter().copied().step_by(2).collect();
    let every_second = format!("{header}\n{}", every_second.join("\n"));
    assert!(refusal(folder, &every_second).contains("tick_rate"));
    let text = lines[..20_000].join("\n");
    let swapped = text.replacen("theta1_rad,theta4_rad", "theta4_rad,theta1_rad", 1);
    assert!(refusal(folder, &swapped).contains("joints are swapped"));
    let currents = text.replacen("current1_a,current4_a", "current4_a,current1_a", 1);
    assert!(refusal(folder, &currents).contains("joints are swapped"));
    assert!(refusal(folder, &lines[..100].join("\n")).contains("0.5 s at least"));
    assert!(refusal(folder, header).contains("0.5 s at least"));
    assert!(refusal(folder, "time_s,theta1_rad\n0,1\n").contains("no column `theta4_rad`"));
}
