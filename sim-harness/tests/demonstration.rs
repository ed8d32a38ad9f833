//! Bare `fivebar`, as a newcomer meets it.

use std::process::Command;

#[test]
fn draws_and_leaves_a_report_that_says_how_well() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_fivebar"))
        .args(["--out", "new/folder"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{said}");
    assert!(said.contains("times real time") && said.contains("new/folder/report.html"));
    let out = folder.path().join("new/folder");
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let report = read("report.html");
    assert!(
        report.contains("PD of equal bandwidth") && report.contains("Torque of joint 1 by cause")
    );
    assert!(report.len() < 2_000_000, "{} bytes", report.len());
    assert!(read("trace.csv").lines().count() > 10_000);
    assert!(read("picture.svg").contains("class=\"ink\""));
    assert!(read("summary.json").contains("\"faults\": []"));
}
