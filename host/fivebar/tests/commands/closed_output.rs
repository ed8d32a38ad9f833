//! Outputs that are closed early, as in `fivebar robots | head -1`, or full.

use fivebar_testkit::program;
use std::process::Stdio;

/// The exit status of a command whose standard output and error are closed. It finds no other program to start: how long
/// those of this machine take is not in question.
fn status_without_reader(arguments: &[&str]) -> Option<i32> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("line.gcode"), "G1 X1 F6000\n").unwrap();
    let mut child = program(env!("CARGO_BIN_EXE_fivebar"))
        .args(arguments)
        .current_dir(folder.path())
        .env("PATH", folder.path())
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
    let scenarios = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/scenarios/");
    let dies = format!("{scenarios}encoder_dies.toml");
    for (arguments, status) in [
        (&["--help"][..], 0),
        (&["--json"], 0),
        (&["accuracy", "benchtop", "--at", "0.04,0.2"], 0),
        (&["accuracy", "benchtop", "--at", "0.04,0.2", "--json"], 0),
        (
            &["clearance", "benchtop", "line.gcode", "--radius", "20e-6"],
            0,
        ),
        (&["completions", "bash"], 0),
        (&["doctor"], 0),
        (&["doctor", "--json"], 0),
        (&["export", "mjcf"], 0),
        (&["export", "dot"], 0),
        (&["calibrate", "--propose", "12", "--plate", "-"], 0),
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
    let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
    let output = command.arg("robots").stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.starts_with("fivebar: cannot print: "), "{message}");
}

/// The file type of what a path names itself.
#[cfg(target_os = "linux")]
fn file_type(path: &std::path::Path) -> std::fs::FileType {
    std::fs::symlink_metadata(path).unwrap().file_type()
}

#[cfg(target_os = "linux")]
#[test]
fn devices_and_links_given_as_files_are_written_into_and_stay() {
    use std::os::unix::fs::FileTypeExt as _;
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("target"), "old").unwrap();
    std::os::unix::fs::symlink("target", path("link")).unwrap();
    std::os::unix::fs::symlink("/dev/full", path("full")).unwrap();
    let status = |arguments: &[&str]| {
        let mut command = program(env!("CARGO_BIN_EXE_fivebar"));
        let output = command.args(arguments).current_dir(folder.path()).output();
        let output = output.unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), message)
    };
    let (code, _) = status(&["export", "dot", "--out", "link"]);
    assert_eq!(code, Some(0));
    assert!(
        std::fs::read_to_string(path("target"))
            .unwrap()
            .contains("graph")
    );
    for full in ["/dev/full", "full"] {
        let (code, message) = status(&["export", "dot", "--out", full]);
        assert_eq!(code, Some(1));
        assert!(message.contains("cannot write"), "{message}");
    }
    let (_, message) = status(&["export", "dot", "--out", "/dev/null"]);
    assert!(!message.contains("cannot write"), "{message}");
    assert!(file_type(&path("link")).is_symlink() && file_type(&path("full")).is_symlink());
    for device in ["/dev/null", "/dev/full"] {
        assert!(file_type(device.as_ref()).is_char_device(), "{device}");
    }
}
