//! `fivebar bridge` and clients that should not move the arm: web browsers, programs that clear a
//! stop by themselves, and those that keep others out.

use crate::bridge::{Bridge, near};
use crate::sender::Sender;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt as _;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Lines that move a homed arm by 5 mm.
const LINES: &str = "$X\nG21\nG91\nG1 X5 F1200\n~\n";

/// Whether the bridge closes the connection within five seconds.
fn is_closed(stream: &mut TcpStream) -> bool {
    let timeout = Some(Duration::from_secs(5));
    stream.set_read_timeout(timeout).expect("an option");
    let mut bytes = [0; 1024];
    loop {
        match stream.read(&mut bytes) {
            Ok(0) => return true,
            Ok(_) => {}
            Err(error) => return error.kind() == std::io::ErrorKind::ConnectionReset,
        }
    }
}

/// Connects as soon as no other sender is in control.
fn connect(bridge: &Bridge) -> Sender {
    let deadline = Instant::now() + Duration::from_secs(5);
    loop {
        let mut sender = bridge.connect();
        let first = sender.line();
        if first.starts_with("Grbl") {
            return sender;
        }
        assert!(Instant::now() < deadline, "{first}");
        sleep(Duration::from_millis(50));
    }
}

#[test]
fn nothing_that_a_web_browser_sends_moves_the_arm() {
    let bridge = Bridge::start();
    let mut sender = connect(&bridge);
    sender.home();
    sender.wait_for("Idle");
    sleep(Duration::from_millis(500));
    let home = sender.wait_for("Idle");
    drop(sender);
    let address = &bridge.address;
    let long = "a".repeat(1100);
    let form = "Content-Type: text/plain\r\nOrigin: null\r\n\r\n";
    for request in [
        format!("POST / HTTP/1.1\r\nHost: {address}\r\n{form}"),
        format!("POST /{long} HTTP/1.1\r\nHost: {address}\r\n{form}"),
        format!("POST /{long}{long} HTTP/1.1\nHost: {address}\n\n"),
        "POST / http/1.1\r\n\r\n".into(),
        "GET /\tHTTP/1.1\r\n\r\n".into(),
        "POST /\r\n".into(),
        "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n".into(),
        format!("{long}\n"),
        format!("Host: {address}\r\n"),
        "Origin: http://example.org\r\n".into(),
        // A greeting of TLS, and what a browser sends for WebRTC.
        "\u{16}\u{3}\u{1}\u{2}\n".into(),
        "\0\u{3}\0\u{8}\n".into(),
    ] {
        let mut stream = connect(&bridge).stream;
        let _ = stream.write_all(format!("{request}{LINES}").as_bytes());
        assert!(is_closed(&mut stream), "it stays connected: {request:?}");
        let (state, place) = connect(&bridge).report();
        assert_eq!(state, "Idle", "{request:?}");
        assert!(near(place, home, 0.1), "{request:?}: {home:?}, {place:?}");
    }
    // What follows an innocent line, too.
    let mut sender = connect(&bridge);
    sender.send(&format!("$I\nPOST / HTTP/1.1\n{LINES}"));
    assert!(is_closed(&mut sender.stream));
    let (_, place) = connect(&bridge).report();
    assert!(near(place, home, 0.1), "{home:?} {place:?}");
}

#[test]
fn without_being_asked_the_bridge_opens_no_port_and_its_terminal_is_its_users() {
    let bridge = Bridge::start_with(&[]);
    assert_eq!(bridge.address, "no-tcp");
    let terminal = std::fs::metadata(&bridge.terminal).expect("a terminal");
    assert_eq!(terminal.permissions().mode() & 0o777, 0o600);
    let files = format!("/proc/{}/fd", bridge.child.id());
    let sockets = std::fs::read_dir(files).expect("a process").flatten();
    let targets = sockets.filter_map(|file| std::fs::read_link(file.path()).ok());
    let is_socket = |path: &std::path::PathBuf| path.to_string_lossy().starts_with("socket:");
    assert_eq!(targets.filter(is_socket).count(), 0);
}

#[test]
fn a_port_without_a_password_is_announced_and_so_is_each_sender() {
    let mut bridge = Bridge::start();
    let address = connect(&bridge).stream.local_addr().expect("an address");
    sleep(Duration::from_millis(500));
    bridge.child.kill().expect("a process");
    let mut text = String::new();
    let errors = bridge.child.stderr.as_mut().expect("its errors");
    errors.read_to_string(&mut text).expect("text");
    let warning = format!("WARNING: no password protects {}", bridge.address);
    assert!(text.contains(&warning), "{text}");
    let peer = format!("a sender is connected: {address}");
    assert!(text.contains(&peer), "{text}");
}

#[test]
fn homing_clears_no_fault_and_a_program_that_connects_clears_none() {
    let bridge = Bridge::start();
    let mut sender = connect(&bridge);
    sender.home();
    assert_eq!(sender.ask("G21 G91 G1 X20 F600"), "ok");
    sender.wait_for("Run");
    sender.send("\x18");
    while sender.line() != "ALARM:3" {}
    for line in ["$H", "G28", "G1 X1"] {
        let answer = sender.ask(line);
        assert!(answer.contains("emergency stop is latched"), "{answer}");
        assert!(answer.ends_with("error:9"), "{answer}");
    }
    // What programs send when they connect, the second one again after a reset of its own.
    for reset in ["", "\x18", "\x18\r\n\r\n"] {
        drop(sender);
        sender = connect(&bridge);
        sender.send(reset);
        sleep(Duration::from_millis(100));
        for line in ["$X", "$H"] {
            sender.send(&format!("{line}\n"));
            while !sender.line().ends_with("error:9") {}
        }
        assert_eq!(sender.report().0, "Alarm");
    }
    sleep(Duration::from_secs(3));
    assert!(sender.ask("$H").ends_with("error:9"));
    assert!(sender.ask("$X").ends_with("ok"));
    assert!(sender.ask("$H").ends_with("ok"));
}

#[test]
fn m112_is_latched_also_with_the_bridges_off() {
    let bridge = Bridge::start();
    let mut sender = connect(&bridge);
    assert!(sender.ask("M105").contains("ok T:"));
    sender.send("M112\n");
    while !sender.line().contains("emergency stop") {}
    sender.send("G28\n");
    while !sender.line().contains("emergency stop is latched") {}
    sender.send("M999\nM114\n");
    let mut line = sender.line();
    while !line.starts_with("X:") {
        assert!(!line.starts_with("Error"), "{line}");
        line = sender.line();
    }
}

#[test]
fn a_silent_sender_loses_its_place_to_another_one_while_the_arm_rests() {
    let bridge = Bridge::start();
    let mut silent = connect(&bridge);
    assert!(
        bridge
            .connect()
            .line()
            .contains("another sender is in control")
    );
    sleep(Duration::from_millis(10_500));
    let mut next = bridge.connect();
    assert!(next.line().starts_with("Grbl"));
    while !silent.line().contains("was silent") {}
    assert!(is_closed(&mut silent.stream));
    // The one in control moves the arm for longer, and needs to say nothing meanwhile.
    next.home();
    next.send("G21 G91 G1 X30 F120\n");
    sleep(Duration::from_millis(10_500));
    let answer = bridge.connect().line();
    let moves = next.report();
    assert!(
        answer.contains("another sender is in control"),
        "{answer} {moves:?}"
    );
    assert_eq!(moves.0, "Run");
}

/// Reports, shares of the feed rate, and pauses, each of which costs the machine time.
#[test]
fn a_sender_that_floods_and_leaves_frees_its_place_at_once() {
    let bridge = Bridge::start();
    for flood in [&b"?"[..], b"\x91\x92", b"!~"] {
        let mut stream = connect(&bridge).stream;
        let timeout = Some(Duration::from_millis(300));
        stream.set_write_timeout(timeout).expect("an option");
        let many = flood.repeat(1 << 15);
        let begun = Instant::now();
        // The bridge may have disconnected it.
        while begun.elapsed() < Duration::from_secs(3) && stream.write_all(&many).is_ok() {}
        let left = Instant::now();
        drop(stream);
        connect(&bridge);
        let waited = left.elapsed();
        assert!(waited < Duration::from_secs(1), "{flood:?}: {waited:?}");
    }
}
