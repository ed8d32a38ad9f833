//! The command `fivebar hil` on a pseudo-terminal with a simulated board.

use crate::arm;
use crate::board::{Board, end, fivebar};
use fivebar_sim::link::Loopback;
use serde_json::Value;
use std::io::Write;
use std::path::Path;

/// Runs a short job on the board. Returns the exit status, the summary and standard error.
fn hil(board: &Board, out: &Path) -> (Option<i32>, Value, String) {
    let mut job = tempfile::Builder::new()
        .suffix(".gcode")
        .tempfile()
        .expect("a temporary file");
    writeln!(job, "G21 G90 F9000\nG0 X0 Y0\nG1 X10 Y0\nG1 X10 Y10")
        .expect("the file can be written");
    let path = |path: &Path| path.to_str().expect("UTF-8 text").to_owned();
    let (job, out) = (path(job.path()), path(out));
    let child = board.fivebar(&["hil", &job, "--json", "--out", &out]);
    let (status, message, err) = end(child);
    let figures = message.lines().last().unwrap_or("null");
    (status, serde_json::from_str(figures).expect("JSON"), err)
}

#[test]
fn a_run_over_a_port_is_bit_identical_to_the_run_in_process() {
    let controller = Loopback::lockstep(&arm::settings()).expect("valid settings");
    let board = Board::start(Some(controller));
    let out = tempfile::tempdir().expect("a temporary folder");
    let (status, figures, err) = hil(&board, out.path());
    assert_eq!(status, Some(0), "{err}");
    assert_eq!(figures["bit_exact"], true, "{figures}");
    assert_eq!(figures["first_difference"], Value::Null);
    assert!(figures["ticks"].as_u64().expect("a number") > 3000);
    assert!(out.path().join("report.html").exists());
}

#[test]
fn a_controller_that_drives_motors_is_refused() {
    let board = Board::start(Some(arm::driving()));
    let out = tempfile::tempdir().expect("a temporary folder");
    let (status, _, err) = hil(&board, out.path());
    assert_eq!(status, Some(1), "{err}");
    assert!(err.contains("has its own clock"), "{err}");
}

#[test]
fn missing_busy_and_silent_ports_are_reported() {
    let out = tempfile::tempdir().expect("a temporary folder");
    let absent = ["hil", "--port", "/dev/nothing", "--out"];
    let path = out.path().to_str().expect("UTF-8 text");
    let (status, _, err) = end(fivebar(&[&absent[..], &[path]].concat()));
    assert_eq!(status, Some(1));
    assert!(err.contains("there is no port /dev/nothing"), "{err}");

    let silent = Board::start(None);
    {
        let _ours = serialport::new(&silent.port, 1_000_000)
            .open()
            .expect("the port opens");
        let (status, _, err) = hil(&silent, out.path());
        assert_eq!(status, Some(1));
        assert!(err.contains("is busy"), "{err}");
    }
    let (status, _, err) = hil(&silent, out.path());
    assert_eq!(status, Some(1));
    assert!(
        err.contains(&silent.port) && err.contains("is silent"),
        "{err}"
    );
}
