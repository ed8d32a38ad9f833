//! The commands `fivebar monitor` and `fivebar drive` on a pseudo-terminal with a simulated board.

use crate::arm;
use crate::board::{Board, end, fivebar};
use fivebar_firmware::SensorSample;
use fivebar_firmware::drives::BrushedSample;
use fivebar_sim::link::Loopback;
use std::io::Write;
use std::process::Command;

/// A job of more than a second.
fn job() -> tempfile::NamedTempFile {
    let mut file = tempfile::Builder::new()
        .suffix(".gcode")
        .tempfile()
        .expect("a temporary file");
    writeln!(file, "G21 G90 F9000\nG0 X0 Y0").expect("the file can be written");
    for _ in 0..6 {
        writeln!(file, "G1 X20 Y0\nG1 X20 Y10\nG1 X0 Y10\nG1 X0 Y0")
            .expect("the file can be written");
    }
    file
}

fn drive(job: &tempfile::NamedTempFile) -> [&str; 2] {
    ["drive", job.path().to_str().expect("UTF-8 text")]
}

#[test]
fn a_monitor_shows_samples_and_counts_losses() {
    let board = Board::start(Some(arm::driving()));
    let child = board.fivebar(&["monitor", "--rate", "100", "--samples", "5"]);
    let (status, out, err) = end(child);
    assert_eq!(status, Some(0), "{err}");
    let lines: Vec<_> = out.lines().collect();
    assert_eq!(lines.len(), 6, "{out}");
    assert!(
        lines[0].contains("Stopped") && lines[0].contains("tool unknown"),
        "{out}"
    );
    assert_eq!(lines[5], "5 samples, 0 lost");
    assert!(err.contains("firmware 0."), "{err}");
}

#[test]
fn a_monitor_shows_raw_inputs_before_settings_and_homing() {
    let pressed = SensorSample {
        counts: [-12_345, 678],
        drives: BrushedSample {
            current: [2047, 2050],
            bus_voltage: 1234,
        },
        home: [false, true],
        index: [true, false],
        emergency_stop: true,
        driver_fault: [true, false],
        missed_ticks: 0,
    };
    let settings = arm::robot().settings().expect("the robot has masses");
    let controller = Loopback::driving(&settings, Box::new(move |_| pressed));
    let board = Board::start(Some(controller.expect("valid settings")));
    // The first sample is asked for before the first tick.
    let child = board.fivebar(&["monitor", "--raw", "--rate", "50", "--samples", "3"]);
    let (status, out, err) = end(child);
    assert_eq!(status, Some(0), "{err}");
    let last: Vec<_> = out
        .lines()
        .last()
        .expect("a line")
        .split_whitespace()
        .collect();
    let expected = "counts -12345 678 currents 2047 2050 codes bus 1234 codes home - pressed index high - \
                    emergency stop pressed bridges fault -";
    assert_eq!(last.join(" "), expected);
}

#[test]
fn a_job_over_a_port_runs_to_its_end() {
    let board = Board::start(Some(arm::driving()));
    let job = job();
    let log = tempfile::NamedTempFile::new().expect("a temporary file");
    let trace = ["--trace", log.path().to_str().expect("UTF-8 text")];
    let (status, out, err) = end(board.fivebar(&[&drive(&job)[..], &trace].concat()));
    assert_eq!(status, Some(0), "{out}{err}");
    assert!(out.contains("25 moves done, bridges off"), "{out}");
    let log = std::fs::read_to_string(log.path()).expect("the log is written");
    assert!(
        log.contains("> HostMessage") && log.contains("Taken"),
        "{log}"
    );
}

#[cfg(feature = "mcap")]
#[test]
fn a_job_over_a_port_is_logged() {
    let board = Board::start(Some(arm::driving()));
    let job = job();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mcap = folder.path().join("logs/run.mcap");
    let log = ["--log", mcap.to_str().expect("UTF-8 text")];
    let (status, out, err) = end(board.fivebar(&[&drive(&job)[..], &log].concat()));
    assert_eq!(status, Some(0), "{out}{err}");
    let mcap = std::fs::read(mcap).expect("the log is written");
    let messages = mcap::MessageStream::new(&mcap).expect("MCAP");
    let tool_messages = messages.filter(|it| it.as_ref().unwrap().channel.topic == "/run");
    let count = tool_messages.count();
    // The tool's position is requested 100 times per second for more than a second.
    assert!(count > 100, "{count} messages");
}

#[test]
fn ctrl_c_stops_the_arm_and_the_line_is_reported() {
    let board = Board::start(Some(arm::driving()));
    let job = job();
    let log = tempfile::NamedTempFile::new().expect("a temporary file");
    let trace = ["--trace", log.path().to_str().expect("UTF-8 text")];
    let child = board.fivebar(&[&drive(&job)[..], &trace].concat());
    // The log shows when homing has ended and the arm moves.
    let moves = || {
        let log = std::fs::read_to_string(log.path()).unwrap_or_default();
        log.matches("state: Running").count()
    };
    while moves() <= 5 {
        let now = board.until(|_| true).tick;
        board.until(|status| status.tick > now);
    }
    let killed = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(killed.expect("`kill` starts").success());
    let (status, _, err) = end(child);
    assert_eq!(status, Some(1), "{err}");
    assert!(err.contains("stopped by the user on line"), "{err}");
    let log = std::fs::read_to_string(log.path()).expect("the log is written");
    assert!(log.contains("Request(Stop)") && log.contains("Request(Disarm)"));
}

#[test]
fn a_missing_port_is_reported_with_the_existing_ones() {
    let (status, _, err) = end(fivebar(&["monitor", "--port", "/dev/nothing"]));
    assert_eq!(status, Some(1));
    assert!(
        err.contains("there is no port /dev/nothing; this machine has"),
        "{err}"
    );
}

#[test]
fn a_busy_port_is_reported() {
    let board = Board::start(Some(arm::driving()));
    let _ours = serialport::new(&board.port, 1_000_000)
        .open()
        .expect("the port opens");
    let (status, _, err) = end(board.fivebar(&["monitor"]));
    assert_eq!(status, Some(1));
    assert!(
        err.contains("is busy: close the program that uses it"),
        "{err}"
    );
}

#[test]
fn a_file_as_port_is_refused() {
    let file = tempfile::NamedTempFile::new().expect("a temporary file");
    let path = file.path().to_str().expect("UTF-8 text");
    let (status, _, err) = end(fivebar(&["monitor", "--port", path]));
    assert_eq!(status, Some(1));
    assert!(err.contains("does not work as a serial port"), "{err}");
}

#[test]
fn a_silent_controller_is_reported_within_seconds() {
    let board = Board::start(None);
    let (status, _, err) = end(board.fivebar(&["monitor"]));
    assert_eq!(status, Some(1));
    assert!(
        err.contains(&board.port) && err.contains("is silent"),
        "{err}"
    );
}
