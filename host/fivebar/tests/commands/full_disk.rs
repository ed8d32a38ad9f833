//! A disk that is nearly full: a file is written whole, or the command says which one is not and fails.

use crate::commission::{commission, record, text};
use fivebar_files::robot::Robot;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs the program with files of at most this many blocks of 512 bytes.
fn limited(folder: &Path, blocks: u32, args: &str) -> Output {
    // With the signal ignored, writing more fails as on a full disk.
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" {args}");
    Command::new("sh")
        .args(["-c", &script, env!("CARGO_BIN_EXE_fivebar")])
        .current_dir(folder)
        .output()
        .unwrap()
}

#[test]
fn a_command_whose_file_does_not_fit_says_so_and_leaves_no_part_of_it() {
    for (args, file) in [
        ("sim line.gcode --robot benchtop --out out", "out/"),
        ("workspace benchtop --resolution 8 --out out", "out/"),
        ("accuracy benchtop --map --out out", "out/report.html"),
        ("mobility five-bar --out out", "out/report.html"),
        ("margins benchtop --out out", "out/report.html"),
        ("linkage four_bar --out out", "out/"),
        ("export urdf --out arm.urdf", "arm.urdf"),
        ("new arm.toml --defaults", "arm.toml"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("line.gcode"), "G0 X0 Y0\nG1 X1 F600\n").unwrap();
        let output = limited(folder.path(), 1, args);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{args}: {message}");
        let named = format!("cannot write {file}");
        assert!(message.contains(&named), "{args}: {message}");
        let left = |path: &Path| fs::read_dir(path).map_or(0, Iterator::count);
        assert_eq!(left(&folder.path().join("out")), 0, "{args}");
        assert!(!folder.path().join(file).is_file(), "{args}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_command_whose_output_does_not_fit_says_so() {
    for args in [
        "robots",
        "robots benchtop",
        "mobility five-bar --json",
        "margins benchtop",
    ] {
        let script = format!("exec \"$0\" {args} > /dev/full");
        let output = Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_fivebar")])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{args}");
        assert!(text(&output.stderr).contains("cannot print"), "{args}");
    }
}

#[test]
fn a_commissioning_claims_only_the_files_that_are_there() {
    let folder = tempfile::tempdir().unwrap();
    let robot = folder.path().join("out/robot.toml");
    let output = commission(folder.path(), &["--until", "motors"]);
    let lines = text(&output.stdout);
    assert!(output.status.success() && !robot.exists());
    assert!(
        !lines.contains("the record and robot.toml are in"),
        "{lines}"
    );
    assert!(
        lines.contains("robot.toml comes with the first step that measures"),
        "{lines}"
    );

    // There is space for the record so far, and not for a robot file.
    let until = "commission --port simulated --out out --until homing";
    let output = limited(folder.path(), 6, until);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("cannot write out/robot.toml"), "{message}");
    assert!(!text(&output.stdout).contains("robot.toml are in"));
    assert!(!robot.exists());
    assert_eq!(record(folder.path())["steps"].as_array().unwrap().len(), 5);

    // With space again it goes on, and what it claims is there.
    let output = commission(folder.path(), &["--until", "homing"]);
    assert!(text(&output.stdout).contains("the record and robot.toml are in"));
    let measured = fs::read_to_string(&robot).unwrap();
    assert!(measured.contains("measured") && Robot::parse("robot.toml", &measured).is_ok());

    // Lost since, its measured values are not taken for the drawing's.
    fs::remove_file(&robot).unwrap();
    let output = commission(folder.path(), &["--until", "homing"]);
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert!(
        message.contains("robot.toml is not there, although step electrics"),
        "{message}"
    );
}
