//! Outputs that are closed early, as in `fivebar robots | head -1`, or full.

use std::process::{Command, Stdio};

/// The exit status of a command whose standard output and error are closed.
fn status_without_reader(arguments: &[&str]) -> Option<i32> {
    let folder = tempfile::tempdir().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_fivebar"))
        .args(arguments)
        .current_dir(folder.path())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop((child.stdout.take(), child.stderr.take()));
    child.wait().unwrap().code()
}

#[test]
fn commands_end_normally_if_their_output_is_closed() {
    let scenarios = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/");
    let dies = format!("{scenarios}encoder_dies.toml");
    for (arguments, status) in [
        (&["--help"][..], 0),
        (&["--json"], 0),
        (&["accuracy", "benchtop", "--at", "0.04,0.2"], 0),
        (&["accuracy", "benchtop", "--at", "0.04,0.2", "--json"], 0),
        (&["clearance", "benchtop", "--radius", "20e-6"], 0),
        (&["completions", "bash"], 0),
        (&["doctor"], 0),
        (&["doctor", "--json"], 0),
        (&["export", "mjcf"], 0),
        (&["export", "dot"], 0),
        (&["linkage"], 0),
        (&["linkage", "shaper"], 0),
        (&["linkage", "shaper", "--json"], 0),
        (&["man"], 0),
        (&["mobility"], 0),
        (&["mobility", "--json"], 0),
        (&["new", "arm.toml", "--defaults"], 0),
        (&["robots"], 0),
        (&["robots", "benchtop"], 0),
        (&["sim", &dies], 1),
        (&["workspace", "--resolution", "4"], 0),
        (&["workspace", "--resolution", "4", "--json"], 0),
        (&["robots", "no-such-robot"], 2),
        (&["sim", "--no-such-option"], 2),
    ] {
        assert_eq!(
            status_without_reader(arguments),
            Some(status),
            "{arguments:?}"
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_output_device_is_reported() {
    let full = std::fs::File::create("/dev/full").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_fivebar"));
    let output = command.arg("robots").stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.starts_with("fivebar: cannot print: "), "{message}");
}
