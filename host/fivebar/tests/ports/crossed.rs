//! `fivebar drive` with an arm that a job has left in its other assembly mode.

use crate::arm;
use crate::board::{Board, end};
use fivebar_files::robot::Robot;
use std::io::Write;

const ROBOT: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../files/robots/short_couplers.toml"
);

/// Drives lines of a job in the frame of the base [mm].
fn drive(board: &Board, lines: &str, options: &[&str]) -> (Option<i32>, String, String) {
    let mut file = tempfile::Builder::new()
        .suffix(".gcode")
        .tempfile()
        .expect("a temporary file");
    write!(file, "G21 G90 F6000\n{lines}").expect("the file can be written");
    let job = file.path().to_str().expect("UTF-8 text");
    let all = ["drive", job, "--robot", ROBOT, "--origin", "0mm,0mm"];
    end(board.fivebar(&[&all[..], options].concat()))
}

#[track_caller]
fn assert_done(found: (Option<i32>, String, String)) {
    let (status, out, err) = found;
    assert_eq!(status, Some(0), "{err}");
    assert!(out.contains("moves done"), "{out}");
}

#[test]
fn a_job_begins_in_the_modes_that_the_arm_is_in() {
    let robot = Robot::load(ROBOT).expect("the robot");
    let board = Board::start(Some(arm::driving_of(&robot)));
    assert_done(drive(&board, "G0 X60 Y115\nM781 X30 Y12 P0.3\n", &[]));
    let behind = "G0 X33 Y12\nG1 X30 Y12\n";
    assert_done(drive(&board, behind, &[]));
    assert_done(drive(&board, behind, &["--time-optimal"]));

    let before = "G0 X60 Y115\nG1 X55 Y115\n";
    let (status, _, err) = drive(&board, before, &[]);
    assert_eq!(status, Some(1));
    assert!(
        err.contains("line 2: ") && err.contains("or cross back with M781 first"),
        "{err}"
    );
    assert_done(drive(&board, "G0 X30 Y12\nM781 X60 Y115 P0.3\n", &[]));
    assert_done(drive(&board, before, &[]));
    let (status, _, err) = drive(&board, behind, &[]);
    assert_eq!(status, Some(1));
    assert!(!err.contains("M781"), "{err}");
}
