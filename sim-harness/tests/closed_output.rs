//! A reader that goes before all is said, as in `fivebar robots | head -1`, and an output
//! that takes nothing.

use std::process::{Command, Stdio};

/// Ends a command whose standard output and error nobody reads; its exit status.
fn unheard(arguments: &[&str]) -> Option<i32> {
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
fn commands_whose_reader_has_gone_end_as_if_they_were_heard() {
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
        assert_eq!(unheard(arguments), Some(status), "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_is_full_is_told() {
    let full = std::fs::File::create("/dev/full").unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_fivebar"));
    let output = command.arg("robots").stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let words = String::from_utf8(output.stderr).unwrap();
    assert!(words.starts_with("fivebar: cannot print: "), "{words}");
}
