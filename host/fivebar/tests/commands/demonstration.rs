//! `fivebar` without arguments.

use fivebar_testkit::program;

#[test]
fn fivebar_without_arguments_draws_and_writes_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let output = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(["--out", "new/folder"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let message = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{message}");
    assert!(message.contains("times real time") && message.contains("new/folder/report.html"));
    let out = folder.path().join("new/folder");
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let report = read("report.html");
    assert!(
        report.contains("PID with feed-forward") && report.contains("Torque of joint 1 by cause")
    );
    assert!(report.len() < 2_000_000, "{} bytes", report.len());
    assert!(read("trace.csv").lines().count() > 10_000);
    assert!(read("picture.svg").contains("class=\"ink\""));
    assert!(read("summary.json").contains("\"faults\": []"));
}
