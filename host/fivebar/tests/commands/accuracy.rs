//! The command `fivebar accuracy`: its results for linkages and sliders, and its errors.

use fivebar_testkit::program;
use serde_json::Value;
use std::process::Output;

fn accuracy(args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.arg("accuracy").args(args).output().unwrap()
}

fn answer(args: &[&str]) -> Value {
    let output = accuracy(&[args, &["--json"]].concat());
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn assert_close(found: &Value, expected: f64, relative: f64) {
    let found = found.as_f64().unwrap();
    let error = (found - expected).abs() / expected.abs();
    assert!(error <= relative, "{found} for {expected}: {error:e}");
}

/// The four-bar of Shi 2005 as a linkage file. The masses of its bars follow from section and
/// length.
#[test]
fn the_loose_four_bar_has_the_scatter_of_the_literature() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let found = answer(&["loose_four_bar", "--samples", "20000", "--out", out]);
    let (links, reactions) = (&found["links"], &found["reactions"]);
    for (link, angle, rate, acceleration) in [
        ("coupler", 0.5965247, -5.42868754, 106.8475),
        ("rocker", 1.7292039, 2.64005585, 204.4018),
    ] {
        assert_close(&links[link]["angle_rad"], angle, 1e-7);
        assert_close(&links[link]["rate_rad_s"], rate, 1e-8);
        assert_close(&links[link]["acceleration_rad_s2"], acceleration, 1e-6);
    }
    for (joint, x, y) in [
        ("ground on crank", -20.28493, -15.17060),
        ("crank on coupler", -18.34551, -12.72662),
        ("coupler on rocker", -5.17420, -5.51100),
        ("ground on rocker", -3.63341, 3.79434),
    ] {
        assert_close(&reactions[joint]["force_n"][0], x, 1e-6);
        assert_close(&reactions[joint]["force_n"][1], y, 1e-6);
    }
    let drive = &found["driving"]["crank"];
    assert_close(&drive["torque_nm"], 0.645954, 1e-6);

    assert_close(&links["coupler"]["angle_sd_rad"], 5.7481e-4, 1e-4);
    assert_close(&links["rocker"]["angle_sd_rad"], 7.7263e-4, 1e-4);
    assert_close(&drive["torque_sd_nm"], 0.028125, 1e-4);
    assert_close(
        &reactions["ground on crank"]["force_sd_n"][0],
        0.83995,
        1e-4,
    );

    // The samples agree within three times their standard error.
    let samples = &found["monte_carlo"];
    assert_eq!(samples["failed"], 0);
    let error = 3.0 * samples["relative_error_of_sd"].as_f64().unwrap();
    assert_close(
        &samples["driving"]["crank"]["torque_sd_nm"],
        0.028125,
        error,
    );
    let sampled = &samples["reactions"]["ground on crank"]["force_sd_n"][0];
    assert_close(sampled, 0.83995, error);
    assert_close(
        &samples["links"]["rocker"]["angle_sd_rad"],
        7.7263e-4,
        error,
    );

    // The sweep over the whole turn, and the contributions to the scatter.
    assert_eq!(found["sweep"]["stations"].as_array().unwrap().len(), 361);
    let first = &drive["contributors"][0];
    assert_eq!(first["name"], "crank rate");
    let shares = drive["contributors"].as_array().unwrap().iter();
    let total: f64 = shares.map(|c| c["share"].as_f64().unwrap()).sum();
    assert!((total - 1.0).abs() < 1e-4);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("driving torque of crank"));
}

#[test]
fn the_map_of_an_arm_shows_the_singularities_of_both_types() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    answer(&["benchtop", "--map", "--out", out]);
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    let map = page.split("role=\"img\"").nth(1).unwrap();
    let curves = map
        .split("<path d=\"M")
        .filter(|path| path.contains("stroke="));
    let long = curves.filter(|path| path.split_whitespace().count() > 50);
    let (dashed, solid): (Vec<_>, Vec<_>) =
        long.partition(|path| path.contains("stroke-dasharray"));
    assert!(
        !dashed.is_empty() && solid.len() >= 2,
        "{dashed:?} {solid:?}"
    );
}

#[test]
fn pins_without_a_stated_direction_are_seated_by_their_reactions() {
    let text = include_str!("../../../files/linkages/four_bar.toml").to_string()
        + "\n[tolerance]\ninput_max = 1e-3\nclearance_radius = 1e-5\n";
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("worn.toml");
    std::fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    let worn = answer(&[file, "--time", "0.1", "--samples", "100"]);
    let new = answer(&["four_bar", "--time", "0.1", "--samples", "100"]);
    assert_eq!(worn["clearances_settled"], true);
    let place = |found: &Value, i: usize| found["points"]["M"]["position_m"][i].as_f64().unwrap();
    let moved = (place(&worn, 0) - place(&new, 0)).hypot(place(&worn, 1) - place(&new, 1));
    let point = &worn["points"]["M"];
    let worst = point["clearance_worst_linear_m"].as_f64().unwrap();
    let rms = point["clearance_rms_m"].as_f64().unwrap();
    assert!(0.0 < rms && rms < worst && worst < 1e-4);
    assert!(1e-7 < moved && moved <= 1.001 * worst, "{moved} of {worst}");
    assert!(point["input_worst_m"].as_f64().unwrap() > 1e-5);
    assert_eq!(new["points"]["M"]["clearance_worst_linear_m"], 0.0);
}

#[test]
fn the_same_seed_gives_the_same_answer() {
    let args = ["loose_four_bar", "--samples", "5000", "--seed", "9"];
    assert_eq!(answer(&args)["monte_carlo"], answer(&args)["monte_carlo"]);
}

#[test]
fn text_output_has_units_and_no_json() {
    let output = accuracy(&["benchtop", "--at", "0.04,0.2", "--samples", "100"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("clearance worst: 19.7 µm\n"), "{text}");
    assert!(
        text.starts_with("the tool scatters by 23.0 µm in x and 21.1 µm in y"),
        "{text}"
    );
    assert!(text.contains("\nmonte carlo:\n  clearance rms:"), "{text}");
    assert!(!text.contains(": 0 "), "{text}");
    assert!(!text.contains(['{', '[', '_']), "{text}");
}

#[test]
fn options_that_do_not_fit_the_file_are_refused() {
    let slider = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/robots/slider.toml");
    for (args, reason) in [
        (vec!["benchtop"], "--at, --path or --map"),
        (vec!["benchtop", "--time", "0"], "--time is for linkages"),
        (vec!["four_bar", "--at", "0,0"], "--time"),
        (vec![slider, "--map"], "only --at"),
    ] {
        let output = accuracy(&args);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(message.contains(reason), "{args:?}: {message}");
    }
    let output = accuracy(&[slider, "--at", "0,2"]);
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("at (0, 2) m"), "{message}");
}

#[test]
fn tolerances_of_unknown_links_joints_or_points_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wrong.toml");
    for (tolerance, reason) in [
        (
            "length_sd = { couplet = 1e-4 }",
            "names `couplet`, which does not exist; there are",
        ),
        ("length_sd = -1e-4", "cannot be -0.0001"),
        ("point_sd = { M = [1e-4, nan] }", "cannot be NaN"),
        (
            "clearance_radius = { \"coupler on crank\" = 1e-5 }",
            "names `coupler on crank`",
        ),
        ("length = 1e-4", "unknown field `length`"),
    ] {
        let text = include_str!("../../../files/linkages/four_bar.toml").to_string();
        let text = format!("{text}\n[tolerance]\n{tolerance}\n");
        let line = text.lines().count();
        std::fs::write(&file, text).unwrap();
        let output = accuracy(&[file.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(1));
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(
            message.contains(reason) && message.contains(&format!("line {line}")),
            "{message}"
        );
    }
}

#[test]
fn an_arm_without_tolerances_gets_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arm.toml");
    let output = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["new", "--defaults"])
        .arg(&file)
        .output()
        .unwrap();
    assert!(output.status.success());
    let warnings = |robot: &str| {
        let output = accuracy(&[robot, "--at", "0.04,0.2", "--samples", "100"]);
        assert!(output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let message = warnings(file.to_str().unwrap());
    assert!(message.contains("has no [tolerance]"), "{message}");
    assert!(!warnings("benchtop").contains("[tolerance]"));
}
