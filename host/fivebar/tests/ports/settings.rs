//! `fivebar settings` and `fivebar clear` on a pseudo-terminal with a simulated board.

use crate::arm;
use crate::board::{Board, end};
use fivebar_firmware::Request;
use fivebar_firmware::protocol::HostCommand;
use fivebar_sim::link::Client;

fn run(board: &Board, arguments: &[&str]) -> (Option<i32>, String, String) {
    end(board.fivebar(arguments))
}

#[test]
fn settings_are_sent_shown_saved_and_sent_back_without_motion() {
    let board = Board::start(Some(arm::driving()));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("settings.toml");
    let file = file.to_str().expect("UTF-8 text");

    let (status, out, err) = run(&board, &["settings", "upload", "--robot", "benchtop_belt"]);
    assert_eq!(status, Some(0), "{err}");
    assert!(
        out.contains("benchtop_belt; home the arm before it moves"),
        "{out}"
    );
    let (_, again, err) = run(&board, &["settings", "upload", "--robot", "benchtop_belt"]);
    assert!(again.contains("no value changed"), "{again}{err}");

    let (status, shown, err) = run(&board, &["settings", "show"]);
    assert_eq!(status, Some(0), "{err}");
    assert!(
        shown.contains("lengths = [0.1, 0.16, 0.16, 0.1, 0.08]  # m"),
        "{shown}"
    );
    assert!(shown.contains("tick_rate = 10000.0  # Hz"), "{shown}");

    let (status, _, err) = run(&board, &["settings", "download", "--out", file]);
    assert_eq!(status, Some(0), "{err}");
    let saved = std::fs::read_to_string(file).expect("the file is written");
    assert_eq!(saved, shown);
    // What exists is not replaced.
    let (status, _, err) = run(&board, &["settings", "download", "--out", file]);
    assert_eq!(status, Some(1), "{err}");

    let (status, _, err) = run(&board, &["settings", "upload", "--robot", "benchtop"]);
    assert_eq!(status, Some(0), "{err}");
    let (status, _, err) = run(&board, &["settings", "upload", "--settings", file]);
    assert_eq!(status, Some(0), "{err}");
    let (_, shown, _) = run(&board, &["settings", "show"]);
    assert_eq!(saved, shown);

    // The monitor shows that the arm has never been powered or homed.
    let (_, out, err) = run(&board, &["monitor", "--rate", "100", "--samples", "2"]);
    assert!(
        out.contains("Stopped") && out.contains("tool unknown"),
        "{out}{err}"
    );
}

#[test]
fn settings_with_three_faults_get_three_answers() {
    let board = Board::start(Some(arm::driving()));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("settings.toml");
    let name = file.to_str().expect("UTF-8 text");
    let (_, mut text, _) = run(&board, &["settings", "show"]);
    for (from, to) in [
        ("payload = ", "payload = -"),
        ("damping = ", "damping = 9"),
        ("back_off = ", "back_off = -"),
    ] {
        assert!(text.contains(from), "{text}");
        text = text.replacen(from, to, 1);
    }
    std::fs::write(&file, text).expect("the file can be written");
    let (status, _, err) = run(&board, &["settings", "upload", "--settings", name]);
    assert_eq!(status, Some(1), "{err}");
    for answer in [
        "control.damping must lie in 0.2 to 2",
        "homing.back_off must be positive and under 1 rad",
        "payload must be finite and not negative",
    ] {
        assert!(
            err.contains(&format!("{name}: {answer}")),
            "{answer}: {err}"
        );
    }
    assert_eq!(err.matches(name).count(), 3, "{err}");
}

#[test]
fn settings_that_are_not_valid_are_refused_before_they_are_sent() {
    let board = Board::start(Some(arm::driving()));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("settings.toml");
    let name = file.to_str().expect("UTF-8 text");
    let (_, before, _) = run(&board, &["settings", "show"]);
    for (from, to, word) in [
        ("payload = ", "payload = -", "payload"),
        ("payload = ", "paylaod = ", "payload"),
        (
            "tick_rate = 10000.0",
            "tick_rate = nan",
            "control.tick_rate",
        ),
    ] {
        let wrong = before.replacen(from, to, 1);
        assert_ne!(wrong, before);
        std::fs::write(&file, wrong).expect("the file can be written");
        let (status, _, err) = run(&board, &["settings", "upload", "--settings", name]);
        assert_eq!(status, Some(1), "{err}");
        assert!(err.contains(name) && err.contains(word), "{err}");
    }
    let (status, _, err) = run(&board, &["settings", "upload"]);
    assert_eq!(status, Some(2), "{err}");
    let (_, after, _) = run(&board, &["settings", "show"]);
    assert_eq!(before, after);
}

#[test]
fn a_latched_fault_is_cleared_by_a_command_of_its_own() {
    let mut controller = arm::driving();
    let (mut client, _) = Client::open(&mut controller).expect("the controller replies");
    let stop = HostCommand::Request(Request::EmergencyStop);
    let accepted = client.command(stop).expect("the link works");
    accepted.expect("an emergency stop is always accepted");
    let board = Board::start(Some(controller));
    let (status, out, err) = run(&board, &["clear"]);
    assert_eq!(status, Some(0), "{err}");
    assert_eq!(out.trim(), "cleared fault 10: emergency stop");
    let (status, out, err) = run(&board, &["clear"]);
    assert_eq!(status, Some(0), "{err}");
    assert_eq!(out.trim(), "no fault is latched");
}
