//! `fivebar bridge` with the simulated arm: a plain client in place of a sender.

use crate::bridge::{Bridge, near};
use crate::sender::Sender;
use std::io::{Read as _, Write as _};
use std::thread::sleep;
use std::time::{Duration, Instant};

#[test]
fn a_sender_homes_draws_pauses_and_resumes() {
    let bridge = Bridge::start();
    let mut sender = bridge.connect();
    assert_eq!(sender.line(), "Grbl 1.1h ['$' for help]");
    assert_eq!(sender.report().0, "Alarm");
    assert!(sender.ask("G1 X1 F600").ends_with("error:9"));
    sender.home();
    let home = sender.wait_for("Idle");
    for line in ["G21 G91", "G92 X0 Y0", "M3 S1000", "G1 X20 F900"] {
        assert_eq!(sender.ask(line), "ok", "{line}");
    }
    sleep(Duration::from_millis(300));
    sender.send("!");
    let held = sender.wait_for("Hold:0");
    assert!(
        held[0] > home[0] + 1.0 && held[0] < home[0] + 18.0,
        "{held:?}"
    );
    assert!((held[1] - home[1]).abs() < 0.1, "{held:?}");
    // Nothing moves while it is held, and a move waits for its answer.
    sender.send("G1 Y10\n");
    sleep(Duration::from_millis(300));
    let (state, still) = sender.report();
    assert_eq!(state, "Hold:0");
    assert!(near(still, held, 0.05), "{still:?} {held:?}");
    sender.send("~");
    assert_eq!(sender.line(), "ok");
    // It draws the rest of the first line before the second.
    let corner = [home[0] + 20.0, home[1]];
    let mut passes_corner = false;
    let end = loop {
        let (state, place) = sender.report();
        passes_corner |= near(place, corner, 1.0);
        if state == "Idle" {
            break place;
        }
    };
    assert!(passes_corner);
    assert!(near(end, [corner[0], corner[1] + 10.0], 0.1), "{end:?}");
}

#[test]
fn a_refused_move_says_why_and_moves_nothing() {
    let bridge = Bridge::start();
    let mut sender = bridge.connect();
    sender.home();
    let before = sender.wait_for("Idle");
    let answer = sender.ask("G91 G1 X900 F900");
    assert!(
        answer.contains("[MSG:joint 1 would leave its limits"),
        "{answer}"
    );
    assert!(answer.ends_with("error:15"), "{answer}");
    let after = sender.wait_for("Idle");
    // From homing on, the arm still comes to its rest: by five counts, which move its tool by 0.1 mm.
    assert!(
        near(after, before, 0.15),
        "{before:?} mm, then {after:?} mm"
    );
}

#[test]
fn a_jog_stops_when_it_is_released() {
    let bridge = Bridge::start();
    let mut sender = bridge.connect();
    sender.home();
    let home = sender.wait_for("Idle");
    assert_eq!(sender.ask("$J=G91 X20 F600"), "ok");
    sleep(Duration::from_millis(300));
    assert_eq!(sender.report().0, "Jog");
    sender.stream.write_all(&[0x85]).unwrap();
    let end = sender.wait_for("Idle");
    assert!(end[0] > home[0] + 1.0 && end[0] < home[0] + 15.0, "{end:?}");
    // The next jog begins there.
    assert_eq!(sender.ask("$J=G91 Y-2 F600"), "ok");
    let next = sender.wait_for("Idle");
    assert!(near(next, [end[0], end[1] - 2.0], 0.1), "{end:?} {next:?}");
}

#[test]
fn an_emergency_stop_waits_for_nothing() {
    let bridge = Bridge::start();
    let mut sender = bridge.connect();
    sender.home();
    // More lines than the controller's queue has room for.
    sender.send("G91\nF300\n");
    for _ in 0..100 {
        sender.send("G1 X10\nG1 X-10\n");
    }
    sender.wait_for("Run");
    let sent = Instant::now();
    sender.send("\x18");
    while sender.line() != "ALARM:3" {}
    assert!(
        sent.elapsed() < Duration::from_millis(500),
        "{:?}",
        sent.elapsed()
    );
    let (state, place) = sender.report();
    assert_eq!(state, "Alarm");
    sleep(Duration::from_millis(300));
    assert!(near(sender.report().1, place, 1.0), "the arm goes on");
    assert!(sender.ask("G1 X1").ends_with("error:9"));
    assert!(sender.ask("$X").ends_with("ok"));
    assert_eq!(sender.report().0, "Idle");
}

#[test]
fn the_arm_of_a_lost_sender_rests_before_another_one_is_in_control() {
    let bridge = Bridge::start();
    let mut sender = bridge.connect();
    sender.home();
    let home = sender.wait_for("Idle");
    let mut other = bridge.connect();
    assert!(other.line().contains("another sender is in control"));
    assert_eq!(sender.ask("G91 G1 X30 F300"), "ok");
    sender.wait_for("Run");
    drop(sender);
    sleep(Duration::from_millis(800));
    let mut next = bridge.connect();
    let (state, place) = next.report();
    assert_eq!(state, "Idle");
    assert!(place[0] < home[0] + 10.0, "{place:?}");
}

#[test]
fn reprap_waits_with_m400_and_asks_for_a_damaged_line_again() {
    let bridge = Bridge::start();
    let mut sender = bridge.connect();
    assert_eq!(sender.line(), "Grbl 1.1h ['$' for help]");
    sender.line();
    assert_eq!(sender.ask("N0 M110 N0*125"), "ok");
    let answer = sender.ask("N1 G28*0");
    assert!(answer.ends_with("Resend: 1 ok"), "{answer}");
    assert!(sender.ask("N1 G28*18").ends_with("ok"));
    for line in ["G91", "G1 X5 F1200", "M400"] {
        assert!(sender.ask(line).ends_with("ok"), "{line}");
    }
    let place = sender.ask("M114");
    let x = place
        .split(['X', ' ', ':'])
        .nth(2)
        .and_then(|x| x.parse::<f64>().ok());
    assert!(x.is_some_and(|x| (x - 5.0).abs() < 0.2), "{place}");
}

#[cfg(unix)]
#[test]
fn the_pseudo_terminal_takes_a_sender_too() {
    let bridge = Bridge::start();
    for _ in 0..2 {
        let mut port = serialport::new(&bridge.terminal, 115_200)
            .timeout(Duration::from_secs(5))
            .open()
            .expect("a terminal");
        port.write_all(b"$I\n").unwrap();
        let mut text = String::new();
        while !text.ends_with("ok\n") {
            let mut byte = [0];
            port.read_exact(&mut byte).expect("an answer");
            text.push(char::from(byte[0]));
        }
        assert!(text.contains("[VER:1.1h"), "{text}");
        drop(port);
        sleep(Duration::from_millis(300));
    }
}

#[test]
fn the_feed_rate_changes_within_a_second_and_a_half_of_the_override() {
    let bridge = Bridge::start();
    let mut sender = bridge.connect();
    assert_eq!(sender.ask("$H").split(' ').next_back(), Some("ok"));
    sender.send("G21 G91\nG1 X60 F600\n");
    let pace = |sender: &mut Sender| {
        let (before, then) = (sender.report().1[0], Instant::now());
        sleep(Duration::from_millis(500));
        (sender.report().1[0] - before) / then.elapsed().as_secs_f64()
    };
    sleep(Duration::from_millis(500));
    let whole = pace(&mut sender);
    for byte in [b"\x92"; 5] {
        sender.stream.write_all(byte).expect("a bridge that reads");
    }
    sleep(Duration::from_millis(1500));
    let half = pace(&mut sender);
    // A busy machine slows both down.
    assert!(
        (0.4..0.6).contains(&(half / whole)),
        "{whole} mm/s, then {half} mm/s"
    );
    // G0 at a quarter. The benchtop arm has no tool whose power could change.
    sender
        .stream
        .write_all(b"\x97\x9B?")
        .expect("a bridge that reads");
    while !sender.line().contains("|Ov:50,25,100>") {}
    // An emergency stop ends the changes.
    sender.send("\x18?");
    while !sender.line().contains("|Ov:100,100,100>") {}
}

/// A robot of each kind of drive.
#[test]
fn a_sender_homes_draws_and_stops_the_arm_whatever_turns_its_joints() {
    for robot in ["benchtop", "benchtop_stepper", "leg", "classroom_servo"] {
        let bridge = Bridge::start_with(&["--listen", "127.0.0.1:0", "--robot", robot]);
        let mut sender = bridge.connect();
        sender.home();
        let home = sender.wait_for("Idle");
        assert_eq!(sender.ask("G21 G91 G1 X10 F900"), "ok", "{robot}");
        let end = sender.wait_for("Idle");
        // Hobby servos rest within their dead band.
        assert!(
            near(end, [home[0] + 10.0, home[1]], 1.0),
            "{robot}: {home:?}, then {end:?} mm"
        );
        sender.send("\x18");
        while sender.line() != "ALARM:3" {}
        assert!(sender.ask("G1 X1").ends_with("error:9"), "{robot}");
    }
}
