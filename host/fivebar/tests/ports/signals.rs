//! Signals that end the program while a board drives its motors: the arm comes to rest, and the
//! bridges are off before the program ends.

use crate::arm::{plant, robot};
use crate::board::{Board, end, fivebar};
use crate::sender::Sender;
use fivebar_firmware::ActuatorCommand;
use fivebar_firmware::safety::{Fault, State};
use fivebar_sim::link::Loopback;
use fivebar_testkit::Running;
use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The signals of a user, of a service manager, and of a terminal that closes; of a user who wants a core, and one that
/// means nothing to the program.
const SIGNALS: [&str; 5] = ["-INT", "-TERM", "-HUP", "-QUIT", "-USR1"];
/// Ticks of the board within which it has done what it was sent.
const SOON: u32 = 10_000;

/// A board, and whether its bridges are on.
fn board() -> (Board, Arc<AtomicBool>) {
    let powered = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&powered);
    let mut plant = plant();
    let robot = robot();
    let period = 1.0 / robot.control.tick_rate;
    let step = move |command: &ActuatorCommand| {
        seen.store(command.enable != [false; 2], Ordering::SeqCst);
        plant.step(command, period);
        plant.sense()
    };
    let settings = robot.settings().expect("the robot has masses");
    let controller = Loopback::driving(&settings, Box::new(step)).expect("valid settings");
    (Board::start(Some(controller)), powered)
}

fn send(signal: &str, child: &Running) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([signal, &id]).status();
    assert!(sent.expect("a program `kill`").success());
}

/// Sends the signal twice, and waits for the program's end. Returns its status.
fn end_by(signal: &str, child: Running, board: &Board, powered: &AtomicBool) -> Option<i32> {
    send(signal, &child);
    send(signal, &child);
    end_of(child, board, powered)
}

/// Waits for the program's end, after which the bridges are off. Returns its status.
fn end_of(mut child: Running, board: &Board, powered: &AtomicBool) -> Option<i32> {
    let status = child.wait().expect("a process");
    // The board does the last request in its next tick.
    board.waits_for_nobody.store(true, Ordering::Relaxed);
    let last = board.until(|_| true).tick + SOON;
    board.until(|status| !powered.load(Ordering::SeqCst) || status.tick > last);
    assert!(!powered.load(Ordering::SeqCst), "the bridges are on");
    status.code()
}

/// The program is held back, until a fault holds the arm with the bridges on.
fn hold_by_a_fault(child: &Running, board: &Board, powered: &AtomicBool) {
    board.until(|status| status.state == State::Running);
    send("-STOP", child);
    board.waits_for_nobody.store(true, Ordering::Relaxed);
    let held = board.until(|status| status.state == State::Fault);
    assert_eq!(held.fault, Some(Fault::CommandTimeout));
    assert!(powered.load(Ordering::SeqCst), "the fault holds the arm");
    // However late the program goes on, the arm is not left alone for long.
    board.waits_for_nobody.store(false, Ordering::Relaxed);
    send("-CONT", child);
}

/// Starts this command with senders over TCP, and has one home the arm and move it.
fn moving(board: &Board, command: &[&str]) -> (Running, Sender) {
    let mut child = board.fivebar(command);
    let output = child.stdout.take().expect("its output");
    let is_address = |word: &&str| word.starts_with("127.0.0.1:");
    let mut lines = BufReader::new(output).lines();
    let address = loop {
        let line = lines.next().expect("an address").expect("text");
        // The first line of `serve` is the page's link.
        if let Some(address) = line.split_whitespace().find(is_address) {
            break address.to_owned();
        }
    };
    let mut sender = Sender::connect(&address);
    sender.home();
    assert_eq!(sender.ask("G21 G91 G1 X30 F600"), "ok");
    sender.wait_for("Run");
    (child, sender)
}

const BRIDGE: [&str; 3] = ["bridge", "--listen", "127.0.0.1:0"];
const SERVE: [&str; 5] = [
    "serve",
    "--listen",
    "127.0.0.1:0",
    "--senders",
    "127.0.0.1:0",
];

/// The output is closed by then, as that of a terminal that is gone.
#[test]
fn a_signal_ends_bridge_and_page_with_the_bridges_off() {
    for (signal, command) in SIGNALS
        .iter()
        .flat_map(|signal| [(signal, &BRIDGE[..]), (signal, &SERVE[..])])
    {
        let (board, powered) = board();
        let (mut child, _sender) = moving(&board, command);
        drop(child.stderr.take());
        let status = end_by(signal, child, &board, &powered);
        assert_eq!(status, Some(0), "{signal} {command:?}");
    }
}

/// A controller that receives nothing holds the arm with the bridges on.
#[test]
fn a_signal_switches_the_bridges_off_also_while_a_fault_holds_the_arm() {
    for command in [&BRIDGE[..], &SERVE[..]] {
        let (board, powered) = board();
        let (child, _sender) = moving(&board, command);
        hold_by_a_fault(&child, &board, &powered);
        let status = end_by("-TERM", child, &board, &powered);
        assert_eq!(status, Some(0), "{command:?}");
    }
}

/// A job of more than a minute, and its folder.
fn long_job() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let job = folder.path().join("job.gcode");
    let text = format!("G21 G90 F1200\nM3\n{}", "G1 X20\nG1 X0\n".repeat(200));
    std::fs::write(&job, text).expect("a file");
    let job = job.to_str().expect("UTF-8 text").to_owned();
    (folder, job)
}

/// The same with a job that `drive` sends.
#[test]
fn a_drive_that_a_fault_holds_ends_with_the_bridges_off() {
    let (_folder, job) = long_job();
    let (board, powered) = board();
    let child = board.fivebar(&["drive", &job]);
    hold_by_a_fault(&child, &board, &powered);
    assert_eq!(end_of(child, &board, &powered), Some(1));
}

/// During homing, and during the job.
#[test]
fn a_signal_ends_a_drive_with_the_bridges_off() {
    let (_folder, job) = long_job();
    for signal in SIGNALS {
        let (board, powered) = board();
        for during in [State::Homing, State::Running] {
            let child = board.fivebar(&["drive", &job]);
            board.until(|status| status.state == during);
            let status = end_by(signal, child, &board, &powered);
            assert_eq!(status, Some(1), "{signal} while {during:?}");
            board.waits_for_nobody.store(false, Ordering::Relaxed);
        }
    }
}

/// The steps by hand are done with a simulated arm; on the board the motors turn at once.
#[test]
fn a_signal_ends_the_commissioning_with_the_bridges_off() {
    for signal in SIGNALS {
        let (board, powered) = board();
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path().to_str().expect("UTF-8 text");
        let by_hand = ["--port", "simulated", "--until", "motors"];
        let (status, _, errors) = end(fivebar(
            &[&["commission", "--out", out], &by_hand[..]].concat(),
        ));
        assert_eq!(status, Some(0), "{errors}");
        let child = board.fivebar(&["commission", "--out", out]);
        board.until(|_| powered.load(Ordering::SeqCst));
        assert_eq!(end_by(signal, child, &board, &powered), Some(1));
    }
}

#[test]
fn a_signal_ends_the_monitor() {
    for signal in SIGNALS {
        let (board, powered) = board();
        let mut child = board.fivebar(&["monitor"]);
        let mut line = String::new();
        let output = child.stdout.as_mut().expect("its output");
        BufReader::new(output).read_line(&mut line).expect("text");
        assert!(line.contains("Stopped"), "{line}");
        assert_eq!(end_by(signal, child, &board, &powered), Some(0), "{signal}");
    }
}

/// Also if the test fails, or its process is killed: then nobody else would end the program.
#[test]
fn a_program_ends_with_the_thread_that_started_it() {
    let start = || {
        let mut shell = fivebar_testkit::program("sh");
        let shell = shell.args(["-c", "echo begun; exec sleep 1000"]);
        let child = shell.stdout(Stdio::piped()).spawn();
        let mut child = child.expect("a program `sh`");
        let mut line = String::new();
        let output = child.stdout.as_mut().expect("its output");
        BufReader::new(output).read_line(&mut line).expect("text");
        child
    };
    let mut child = std::thread::spawn(start).join().expect("no panic");
    assert_eq!(child.wait().expect("a process").code(), None, "by a signal");
}
