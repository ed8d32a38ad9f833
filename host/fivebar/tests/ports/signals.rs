//! Signals that end the program while a board drives its motors: the arm comes to rest, and the
//! bridges are off before the program ends.

use crate::arm::{plant, robot};
use crate::board::{Board, end, fivebar};
use crate::bridge::Sender;
use fivebar_firmware::ActuatorCommand;
use fivebar_sim::link::Loopback;
use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The signals of a user, of a service manager, and of a terminal that closes.
const SIGNALS: [&str; 3] = ["-INT", "-TERM", "-HUP"];
/// Longest wait for the program's end.
const LONGEST: Duration = Duration::from_secs(20);

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

fn send(signal: &str, child: &Child) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([signal, &id]).status();
    assert!(sent.expect("a program `kill`").success());
}

/// Waits for the bridges to be on.
fn wait_for(powered: &AtomicBool) {
    let deadline = Instant::now() + LONGEST;
    while !powered.load(Ordering::SeqCst) {
        assert!(Instant::now() < deadline, "the bridges stay off");
        sleep(Duration::from_millis(5));
    }
}

/// Sends the signal twice, and waits for the program's end. Returns its status.
fn end_by(signal: &str, mut child: Child, powered: &AtomicBool) -> Option<i32> {
    send(signal, &child);
    sleep(Duration::from_millis(20));
    let _ = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status();
    let deadline = Instant::now() + LONGEST;
    let status = loop {
        if let Some(status) = child.try_wait().expect("a process") {
            break status;
        }
        assert!(Instant::now() < deadline, "{signal} does not end it");
        sleep(Duration::from_millis(10));
    };
    // The board does the last request in its next tick.
    let deadline = Instant::now() + Duration::from_secs(1);
    while powered.load(Ordering::SeqCst) {
        assert!(Instant::now() < deadline, "{signal}: the bridges are on");
        sleep(Duration::from_millis(5));
    }
    status.code()
}

/// Starts this command with senders over TCP, and has one home the arm and move it.
fn moving(board: &Board, command: &[&str]) -> (Child, Sender) {
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
        assert!(powered.load(Ordering::SeqCst));
        assert_eq!(end_by(signal, child, &powered), Some(0), "{command:?}");
    }
}

/// A controller that receives nothing holds the arm with the bridges on.
#[test]
fn a_signal_switches_the_bridges_off_also_while_a_fault_holds_the_arm() {
    for command in [&BRIDGE[..], &SERVE[..]] {
        let (board, powered) = board();
        let (child, _sender) = moving(&board, command);
        board.waits_for_nobody.store(true, Ordering::Relaxed);
        send("-STOP", &child);
        sleep(Duration::from_secs(1));
        assert!(powered.load(Ordering::SeqCst), "the fault holds the arm");
        send("-CONT", &child);
        assert_eq!(end_by("-TERM", child, &powered), Some(0), "{command:?}");
    }
}

/// The same with a job that `drive` sends.
#[test]
fn a_drive_that_a_fault_holds_ends_with_the_bridges_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let job = folder.path().join("job.gcode");
    let text = format!("G21 G90 F1200\nM3\n{}", "G1 X20\nG1 X0\n".repeat(200));
    std::fs::write(&job, text).expect("a file");
    let (board, powered) = board();
    let mut child = board.fivebar(&["drive", job.to_str().expect("UTF-8 text")]);
    wait_for(&powered);
    sleep(Duration::from_secs(3));
    board.waits_for_nobody.store(true, Ordering::Relaxed);
    send("-STOP", &child);
    sleep(Duration::from_secs(1));
    assert!(powered.load(Ordering::SeqCst), "the fault holds the arm");
    send("-CONT", &child);
    assert_eq!(child.wait().expect("an end").code(), Some(1));
    sleep(Duration::from_millis(20));
    assert!(!powered.load(Ordering::SeqCst), "the bridges are on");
}

/// During homing, and during the job.
#[test]
fn a_signal_ends_a_drive_with_the_bridges_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let job = folder.path().join("job.gcode");
    let text = format!("G21 G90 F1200\nM3\n{}", "G1 X20\nG1 X0\n".repeat(200));
    std::fs::write(&job, text).expect("a file");
    let job = job.to_str().expect("UTF-8 text");
    for signal in SIGNALS {
        let (board, powered) = board();
        for wait in [50, 3000] {
            let child = board.fivebar(&["drive", job]);
            wait_for(&powered);
            sleep(Duration::from_millis(wait));
            assert_eq!(end_by(signal, child, &powered), Some(1));
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
        wait_for(&powered);
        assert_eq!(end_by(signal, child, &powered), Some(1));
    }
}

#[test]
fn a_signal_ends_the_monitor() {
    for signal in SIGNALS {
        let (board, powered) = board();
        let child = board.fivebar(&["monitor"]);
        sleep(Duration::from_millis(500));
        assert_eq!(end_by(signal, child, &powered), Some(0));
    }
}
