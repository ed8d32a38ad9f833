//! The command `fivebar calibrate`: answers, files and refusals.

use fivebar_design::Noise;
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Geometry;
use fivebar_testkit::program;
use nalgebra::{Rotation2, Vector2};
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::Output;

/// Holes touched with the benchtop arm, from `tests/data/calibration_public.json`.
const POINTS: &str = include_str!("../../../files/measurements/benchtop_holes.csv");

fn calibrate(args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.arg("calibrate").args(args).output().unwrap()
}

fn answer(args: &[&str]) -> Value {
    let output = calibrate(&[args, &["--json"]].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn table(folder: &Path, text: &str) -> String {
    let path = folder.join("touched.csv");
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

#[test]
fn the_answer_has_every_key_with_its_deviation() {
    let folder = tempfile::tempdir().unwrap();
    let points = table(folder.path(), POINTS);
    let robust = answer(&["--robot", "benchtop", "--points", &points]);
    let plain = answer(&["--points", &points, "--plain"]);
    for found in [&robust, &plain] {
        for (key, count) in [("link_lengths", 5), ("joint_offsets", 2)] {
            for key in [key.to_owned(), format!("{key}_sd")] {
                assert_eq!(found[&key].as_array().unwrap().len(), count, "{key}");
            }
        }
        for key in ["x", "y", "phi"] {
            assert!(found["placement"][key].is_f64() && found["placement_sd"][key].is_f64());
        }
        assert_eq!(found["rank"], 10);
        let condition = found["condition"].as_f64().unwrap();
        assert!((40.0..46.0).contains(&condition), "{condition}");
    }
    assert_eq!(robust["rejected"], serde_json::json!([9, 10, 18]));
    // Wrong holes move the plain fit, so that others are far from it, too.
    assert!(plain["rejected"].as_array().unwrap().len() > 3);
    // Least squares over all rows, and over those that are right.
    let l2 = |found: &Value| found["link_lengths"][1].as_f64().unwrap();
    let right = POINTS
        .lines()
        .enumerate()
        .filter(|(row, _)| ![9, 10, 18].contains(row));
    let right: Vec<_> = right.map(|(_, line)| line).collect();
    let other = tempfile::tempdir().unwrap();
    let right = table(other.path(), &right.join("\n"));
    let right = answer(&["--points", &right, "--plain"]);
    // Huber's loss weighs the right ones a little, a third of a deviation at most.
    let sd = right["link_lengths_sd"][1].as_f64().unwrap();
    assert!(
        (l2(&robust) - l2(&right)).abs() < sd / 3.0,
        "{robust} {right}"
    );
    assert!((l2(&plain) - 0.15956946).abs() < 1e-6);
    let rms = |found: &Value| found["residual_rms_m"].as_f64().unwrap();
    assert!((rms(&plain) - 1.274568e-4).abs() < 1e-8);
    assert!(rms(&robust) < 20e-6);
    // Twice the deviation of the holes gives twice that of the lengths.
    let doubled = answer(&["--points", &points, "--plain", "--sigma", "40e-6"]);
    let sd = |found: &Value| found["link_lengths_sd"][0].as_f64().unwrap();
    assert!((sd(&doubled) / sd(&plain) - 2.0).abs() < 1e-9);
}

#[test]
fn the_robot_file_is_rewritten_and_the_old_one_kept() {
    let folder = tempfile::tempdir().unwrap();
    let points = table(folder.path(), POINTS);
    let out = folder.path().join("arm.toml");
    let name = out.to_str().unwrap();
    let found = answer(&["--points", &points, "--out", name]);
    let first = std::fs::read_to_string(&out).unwrap();
    assert!(first.contains("by calibration; before: 0.16\n"), "{first}");
    let robot = Robot::load(name).unwrap();
    for (own, wanted) in robot.geometry.lengths().iter().zip(0..) {
        assert!((own - found["link_lengths"][wanted].as_f64().unwrap()).abs() < 1e-9);
    }
    let turned = robot.home[0] - 2.7925268;
    assert!((turned - found["joint_offsets"][0].as_f64().unwrap()).abs() < 1e-8);
    let again = calibrate(&["--robot", name, "--points", &points, "--out", name]);
    assert!(again.status.success());
    let kept = folder.path().join("arm.toml.old");
    assert_eq!(std::fs::read_to_string(kept).unwrap(), first);
}

/// Holes that a leg with other lengths and zeros than the built-in one touches, on a plate that is turned against it.
fn touched_by_a_leg(turn: f64) -> (String, [f64; 5]) {
    let leg = Robot::load("leg").unwrap();
    let lengths = [0.0902, 0.1597, 0.1604, 0.0899, 0.0];
    let made = Geometry::new(lengths).unwrap();
    let mut noise = Noise::new(5);
    let mut text = String::from("counts1,counts4,x,y\n");
    for x in [-0.08, -0.04, 0.0, 0.05, 0.09] {
        for y in [0.12, 0.15, 0.18, 0.2, 0.21] {
            let pose = made.inverse(Vector2::new(x, y), leg.elbows).unwrap();
            let [theta1, _, _, theta4] = pose.angles();
            let drives = leg.actuators.as_ref().unwrap().iter();
            for (drive, theta) in drives.zip([theta1 - 0.01, theta4 + 0.02]) {
                let per_turn = f64::from(drive.encoder_counts) * drive.gear_ratio;
                text += &format!("{},", (theta / TAU * per_turn).floor());
            }
            let hole = Rotation2::new(turn) * Vector2::new(x, y) + Vector2::new(0.3, -0.1);
            let [x, y]: [f64; 2] =
                (hole + 20e-6 * Vector2::new(noise.normal(), noise.normal())).into();
            text += &format!("{x},{y}\n");
        }
    }
    (text, lengths)
}

/// The warnings that speak of both zeros.
fn of_zeros(found: &Value) -> Vec<&str> {
    let warnings = found["warnings"].as_array().unwrap().iter();
    let texts = warnings.map(|warning| warning.as_str().unwrap());
    texts
        .filter(|text| text.starts_with("both joints' zeros"))
        .collect()
}

#[test]
fn a_leg_with_both_hips_about_one_axis_keeps_its_base_of_zero() {
    let folder = tempfile::tempdir().unwrap();
    let (text, lengths) = touched_by_a_leg(0.0);
    let points = table(folder.path(), &text);
    let out = folder.path().join("leg.toml");
    let name = out.to_str().unwrap();
    let leg = ["--robot", "leg", "--points", &points, "--out", name];
    let found = answer(&leg);
    assert_eq!(found["rank"], 8);
    for held in [
        &found["link_lengths_sd"][4],
        &found["link_lengths"][4],
        &found["placement"]["phi"],
    ] {
        assert_eq!(held, 0.0);
    }
    for (link, length) in lengths.into_iter().enumerate().take(4) {
        let of = |key: &str| found[key][link].as_f64().unwrap();
        let (own, sd) = (of("link_lengths"), of("link_lengths_sd"));
        assert!(
            (own - length).abs() < 5.0 * sd && sd < 1e-4,
            "{own} ± {sd}: {length}"
        );
    }
    assert_eq!(of_zeros(&found), [""; 0]);
    let rms = |key: &str| found[key].as_f64().unwrap();
    assert!(
        rms("tip_error_rms_m") < 20e-6
            && rms("tip_error_before_rms_m") > 10.0 * rms("tip_error_rms_m")
    );
    let written = std::fs::read_to_string(&out).unwrap();
    assert!(
        written.contains("# Both hips turn about one axis.\nbase = 0.0\n"),
        "{written}"
    );
    let robot = Robot::load(name).unwrap();
    assert!(
        (robot.home[0] - 2.7925268 - 0.01).abs() < 1e-3,
        "{:?}",
        robot.home
    );
    let output = calibrate(&leg);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(text.matches("held").count(), 2, "{text}");
}

#[test]
fn a_plate_that_lies_turned_under_a_leg_turns_its_zeros_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let points = table(folder.path(), &touched_by_a_leg(0.3).0);
    let found = answer(&["--robot", "leg", "--points", &points]);
    for (joint, off) in [0.01, -0.02].into_iter().enumerate() {
        let own = found["joint_offsets"][joint].as_f64().unwrap();
        assert!((own - off - 0.3).abs() < 1e-3, "{own}");
    }
    let warnings = of_zeros(&found);
    assert_eq!(warnings.len(), 1, "{found}");
    assert!(warnings[0].contains(" off by 16.9° on the mean"), "{found}");
}

#[test]
fn refusals_name_the_reason_and_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("arm.toml");
    let header = "counts1,counts4,x,y\n";
    let few: String = POINTS
        .lines()
        .take(5)
        .map(|line| format!("{line}\n"))
        .collect();
    let swapped = POINTS.replace("counts1,counts4", "counts4,counts1");
    let nan = POINTS.replacen("-57829", "nan", 1);
    for (text, reason) in [
        (header, "too few points: 0"),
        (&few, "too few points: 4"),
        (&swapped, "joints are swapped"),
        (&nan, "line 2: `counts1` must be a finite number"),
        ("counts1,x,y\n1,2,3\n", "no column `counts4`"),
    ] {
        let points = table(folder.path(), text);
        let output = calibrate(&["--points", &points, "--out", out.to_str().unwrap()]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(output.stdout.is_empty() && !out.exists());
        assert!(
            message.contains(reason) && message.contains("touched.csv"),
            "{message}"
        );
    }
    assert_eq!(calibrate(&[]).status.code(), Some(2));
    assert_eq!(calibrate(&["--propose", "4"]).status.code(), Some(2));
}

#[test]
fn poses_are_proposed_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let plate = folder.path().join("plate.svg");
    let found = answer(&["--propose", "12", "--plate", plate.to_str().unwrap()]);
    assert_eq!(found["poses"].as_array().unwrap().len(), 12);
    assert!(found["observability_o1"].as_f64().unwrap() >= 0.044);
    let drawn = std::fs::read_to_string(plate).unwrap();
    assert_eq!(drawn.matches("<circle").count(), 12);
}

/// A table of `host/files/measurements`, all of one arm.
fn measurements(name: &str) -> String {
    format!(
        "{}/../files/measurements/benchtop_{name}.csv",
        env!("CARGO_MANIFEST_DIR")
    )
}

#[test]
fn distances_unknown_holes_and_photographs_find_the_arm_of_the_plate() {
    let tables = ["holes", "bars", "unknown_holes", "photo"].map(measurements);
    let [plate, bars, holes, photo] = tables.each_ref().map(String::as_str);
    // The arm as made: set 2 of tests/data/calibration_public.json.
    let truth = [
        0.100056716,
        0.159843175,
        0.159876081,
        0.099267560,
        0.080539912,
    ];
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("map.svg");
    let map = map.to_str().unwrap();
    for (args, rank, kinds) in [
        (vec!["--bars", bars], 7, 1),
        (vec!["--holes", holes, "--bars", bars], 7, 2),
        (vec!["--photo", photo, "--bars", bars], 7, 2),
        (
            vec!["--points", plate, "--photo", photo, "--photo", photo],
            10,
            3,
        ),
        (
            vec![
                "--points", plate, "--holes", holes, "--bars", bars, "--map", map,
            ],
            10,
            3,
        ),
    ] {
        let found = answer(&args);
        assert_eq!(found["rank"], rank, "{args:?}");
        assert_eq!(found["kinds"].as_array().unwrap().len(), kinds);
        assert_eq!(found["placement"].is_null(), rank == 7);
        for (index, truth) in truth.into_iter().enumerate() {
            let own = found["link_lengths"][index].as_f64().unwrap();
            let sd = found["link_lengths_sd"][index].as_f64().unwrap();
            assert!(
                (own - truth).abs() < 3.5 * sd,
                "{args:?} {index}: {own} ± {sd} for {truth}"
            );
        }
        let tip = |key: &str| found[key].as_f64().unwrap();
        assert!(tip("tip_error_rms_m") < 25e-6 && tip("tip_error_before_rms_m") > 0.9e-3);
    }
    let drawn = std::fs::read_to_string(map).unwrap();
    assert!(drawn.contains("before: found") && drawn.contains("after: expected"));
}

#[test]
fn measurements_that_tell_too_little_are_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("arm.toml");
    let map = folder.path().join("map.svg");
    let [bars, holes, photo] = ["bars", "unknown_holes", "photo"].map(measurements);
    let plate = measurements("holes");
    let short = folder.path().join("short.csv");
    let rows = std::fs::read_to_string(&bars).unwrap();
    let rows = rows.lines().enumerate().map(|(index, row)| match index {
        0 => format!("{row}\n"),
        _ => format!("{},0.05\n", row.rsplit_once(',').unwrap().0),
    });
    std::fs::write(&short, rows.collect::<String>()).unwrap();
    let short = short.to_str().unwrap();
    let half = table(folder.path(), "hole,counts1,counts4\n1.5,3,4\n");
    for (args, reason) in [
        (
            vec!["--holes", &holes],
            "no known length: scale is not seen",
        ),
        (
            vec!["--photo", &photo, "--holes", &holes],
            "scale is not seen",
        ),
        (vec!["--holes", &bars], "no column `hole`"),
        (
            vec!["--points", &plate, "--bars", short],
            "24 of 24 rows are farther than 4 σ",
        ),
        (
            vec!["--bars", &bars, "--holes", &half],
            "must be a whole number, not 1.5",
        ),
    ] {
        let files = [
            "--out",
            out.to_str().unwrap(),
            "--map",
            map.to_str().unwrap(),
        ];
        let output = calibrate(&[&args[..], &files].concat());
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains(reason), "{message}");
        assert!(output.stdout.is_empty() && !out.exists() && !map.exists());
    }
    let drawn = calibrate(&["--points", &plate, "--plate", short]);
    assert_eq!(drawn.status.code(), Some(2));
    let few = folder.path().join("few.csv");
    let seven: String = std::fs::read_to_string(&bars)
        .unwrap()
        .lines()
        .take(9)
        .map(|line| format!("{line}\n"))
        .collect();
    std::fs::write(&few, seven).unwrap();
    let output = calibrate(&["--bars", few.to_str().unwrap()]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("only 1 more measurements than unknowns"),
        "{message}"
    );
    assert_eq!(
        calibrate(&["--propose", "12", "--bars", &bars])
            .status
            .code(),
        Some(2)
    );
}

#[test]
fn the_text_has_a_unit_on_every_number() {
    let output = calibrate(&["--points", &measurements("holes")]);
    let text = String::from_utf8(output.stdout).unwrap();
    for wanted in [
        "  l1    100.0640 mm       6.98 µm     100.0000 mm\n",
        "  φ     -11.0445 mrad    386 µrad\n",
        "residuals of 24 rows (plate), 3 of them named as wrong: 15.3 µm RMS\n",
        "expected now: 13.0 µm RMS, 18.1 µm at the worst place\n",
    ] {
        assert!(text.contains(wanted), "{wanted} in {text}");
    }
}
