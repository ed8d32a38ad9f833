//! The command `fivebar linkage`: its output, files and errors.

use fivebar_testkit::program;
use std::path::Path;
use std::process::Output;

fn linkage(args: &[&str]) -> Output {
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    command.arg("linkage").args(args).output().unwrap()
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn the_examples_are_listed_if_none_is_named() {
    let output = linkage(&[]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.lines().count() >= 9 && text.contains("shaper"),
        "{text}"
    );
}

#[test]
fn a_linkage_that_never_closes_ends_with_status_1_and_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("short.toml");
    let text = include_str!("../../../files/linkages/four_bar.toml");
    let text = text.replace("lengths = [0.30, 0.25]", "lengths = [0.05, 0.05]");
    std::fs::write(&file, text).unwrap();
    let out = folder.path().join("out");
    let output = linkage(&[file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("closes at no instant") && message.contains("check `lengths`"));
    assert!(read(&out, "summary.json").contains("\"closed\": 0"));
}

#[test]
fn the_report_the_table_and_the_summary_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let output = linkage(&["four_bar", "--out", out, "--json"]);
    assert!(output.status.success());
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let written: serde_json::Value =
        serde_json::from_str(&read(folder.path(), "summary.json")).unwrap();
    assert_eq!(printed, written);
    assert_eq!(printed["freedoms"], 1);
    assert!(
        printed["grashof"]
            .as_str()
            .unwrap()
            .starts_with("crank-rocker")
    );
    // Crank and frame in line: cos μ = (b² + c² − (d ∓ a)²) / (2 b c).
    let [least, greatest] =
        ["min", "max"].map(|key| printed["transmission"][0][key].as_f64().unwrap());
    let at = |diagonal: f64| ((0.09 + 0.0625 - diagonal * diagonal) / 0.15_f64).acos();
    assert!((least - at(0.25).to_degrees()).abs() < 1e-9, "{least}");
    assert!(greatest <= 90.0 && greatest > 89.0);

    let table = read(folder.path(), "table.csv");
    let mut rows = table.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    assert_eq!(rows.clone().count(), 361);
    for row in rows {
        assert_eq!(row.len(), header.len());
        assert!(
            row.iter()
                .rev()
                .skip(1)
                .all(|cell| cell.parse::<f64>().is_ok())
        );
    }
    let report = read(folder.path(), "report.html");
    for part in [
        "<canvas",
        "Transmission angle",
        "ω1 = (Ṗ2−Ṗ1)·r2/X",
        "peak moment",
    ] {
        assert!(report.contains(part), "{part}");
    }
}

#[test]
fn the_ends_of_a_motion_are_printed_and_rows_beyond_are_empty() {
    let folder = tempfile::tempdir().unwrap();
    let text = include_str!("../../../files/linkages/four_bar.toml")
        .replace("[0.30, 0.25]", "[0.15, 0.25]");
    let file = folder.path().join("short.toml");
    std::fs::write(&file, text).unwrap();
    let out = folder.path().join("out");
    let [file, out_dir] = [&file, &out].map(|path| path.to_str().unwrap());
    let output = linkage(&[file, "--out", out_dir]);
    assert!(output.status.success());
    let message = String::from_utf8(output.stdout).unwrap();
    assert!(
        message.contains("motion ends") && message.contains("motion begins"),
        "{message}"
    );
    assert!(message.contains("coupler–rocker cannot close"), "{message}");
    let table = read(&out, "table.csv");
    let blank = table.lines().filter(|row| row.contains("cannot close"));
    let blank: Vec<_> = blank.collect();
    assert!(blank.len() > 30);
    assert!(blank.iter().all(|row| row.contains(",,,,,,")));
}

#[test]
fn refused_commands_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let refused = |args: &[&str], status: i32, message: &str| {
        let output = linkage(args);
        assert_eq!(output.status.code(), Some(status));
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.contains(message), "{text}");
    };
    let out_dir = out.to_str().unwrap();
    refused(
        &["no_such", "--out", out_dir],
        1,
        "neither a built-in example nor a file",
    );
    assert!(!out.exists());
    let taken = folder.path().join("taken");
    std::fs::write(&taken, "").unwrap();
    refused(
        &["four_bar", "--out", taken.to_str().unwrap()],
        1,
        "cannot write",
    );
    refused(&["four_bar", "--no-such-option"], 2, "--no-such-option");
}
