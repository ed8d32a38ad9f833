//! Stops with the bridges off: what latches, what is dropped, who may go on and when.

use super::rig::Rig;
use crate::bridge::slot::CLEARING;
use fivebar_firmware::Request;
use fivebar_firmware::safety::{Fault, State};

const RESET: &str = "\u{18}";
const GREETING: &str = "\r\nGrbl 1.1h ['$' for help]\n";
const LOCKED: &str = "\r\nGrbl 1.1h ['$' for help]\n[MSG:'$H'|'$X' to unlock]\n";
const ALARM: &str = "ALARM:3\n[MSG:emergency stop, the bridges are off; $X clears it]\n";

#[test]
fn a_reset_switches_a_moving_arm_off_and_its_sender_clears_it_at_once() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    sender.say(RESET);
    rig.round();
    assert_eq!(rig.status().fault, Some(Fault::EmergencyStop));
    assert_eq!(rig.answer(&sender), format!("{ALARM}{LOCKED}"));
    assert!(rig.slot.path.queue.is_empty() && rig.rests());
    let answer = rig.asked(&sender, "$X\n");
    assert_eq!(answer, "[MSG:Caution: Unlocked]\nok\n");
    assert_eq!(rig.state(), State::Stopped);
    assert_eq!(rig.asked(&sender, "G91 G1 X-5 F3000\n"), "ok\n");
    assert_eq!(rig.state(), State::Armed);
}

#[test]
fn a_reset_latches_nothing_while_the_bridges_are_off() {
    for (mut rig, greeting) in [(Rig::homed(), GREETING), (Rig::new(), LOCKED)] {
        let sender = rig.connect();
        sender.say(RESET);
        rig.round();
        assert_eq!(rig.status().fault, None);
        assert_eq!(rig.answer(&sender), greeting);
    }
}

#[test]
fn an_emergency_stop_latches_also_while_the_bridges_are_off_and_a_reset_after_it_does_not() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    sender.say("M112\n");
    rig.round();
    assert_eq!(rig.status().fault, Some(Fault::EmergencyStop));
    assert_eq!(rig.answer(&sender), format!("{ALARM}{LOCKED}ok\n"));
    rig.asked(&sender, "$X\n");
    assert_eq!(rig.state(), State::Stopped);
    sender.say(RESET);
    rig.round();
    assert_eq!(rig.status().fault, None);
    assert_eq!(rig.answer(&sender), GREETING);
}

#[test]
fn a_reset_does_not_shorten_the_wait_after_a_stop_that_came_from_elsewhere() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    rig.session
        .request(Request::EmergencyStop)
        .unwrap()
        .unwrap();
    rig.round();
    assert_eq!(rig.note().as_deref(), Some("a sender is connected: a test"));
    assert_eq!(rig.note().as_deref(), Some("fault 10, emergency stop"));
    sender.say(RESET);
    rig.round();
    rig.answer(&sender);
    let answer = rig.asked(&sender, "$X\n");
    assert!(
        answer.contains("[MSG:emergency stop is latched: wait ") && answer.ends_with("error:9\n"),
        "{answer}"
    );
    assert_eq!(rig.state(), State::Fault);
}

/// Also after an order of which nothing waits.
#[test]
fn a_fault_is_reported_with_its_name_and_ends_the_path() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    rig.session
        .request(Request::EmergencyStop)
        .unwrap()
        .unwrap();
    rig.round();
    let answer = rig.answer(&sender);
    assert!(
        answer.contains("ALARM:3\n[MSG:fault 10, emergency stop; $X clears it]\n"),
        "{answer}"
    );
    assert!(rig.slot.path.queue.is_empty());
    let answer = rig.asked(&sender, "G1 X-1\n");
    assert_eq!(
        answer,
        "[MSG:emergency stop is latched: $X or M999 clears it]\nerror:9\n"
    );
    let answer = rig.asked(&sender, "$H\n");
    assert!(answer.ends_with("error:9\n"), "{answer}");
    assert_eq!(rig.state(), State::Fault);
    assert!(rig.report(&sender).starts_with("<Alarm|"));
}

#[test]
fn a_sender_that_connects_to_a_latched_fault_waits_before_it_clears_it() {
    let mut rig = Rig::homed();
    rig.session
        .request(Request::EmergencyStop)
        .unwrap()
        .unwrap();
    rig.round();
    rig.session.clock.sleep(CLEARING);
    let sender = rig.call();
    rig.until(|rig| rig.slot.sender.is_some());
    assert_eq!(rig.answer(&sender), LOCKED);
    let answer = rig.asked(&sender, "$X\n");
    assert!(
        answer.contains("wait ") && answer.ends_with("error:9\n"),
        "{answer}"
    );
    rig.session.clock.sleep(CLEARING);
    assert!(rig.asked(&sender, "$X\n").ends_with("ok\n"));
    assert_eq!(rig.state(), State::Stopped);
}

#[test]
fn a_sender_is_greeted_with_the_way_to_unlock_an_arm_that_is_not_homed() {
    for (mut rig, greeting) in [(Rig::homed(), GREETING), (Rig::new(), LOCKED)] {
        let sender = rig.call();
        rig.until(|rig| rig.slot.sender.is_some());
        assert_eq!(rig.answer(&sender), greeting);
    }
}

#[test]
fn what_came_before_a_stop_is_dropped_and_what_comes_after_it_is_done() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    let text = format!("G1 X-1\n$N\n!{RESET}$I\n");
    let place = rig.status().tool;
    sender.say(&text);
    rig.round();
    rig.until_rest();
    let answer = rig.answer(&sender);
    assert!(
        answer.starts_with(&format!("{ALARM}{LOCKED}[VER:")),
        "{answer}"
    );
    assert!(
        answer.ends_with("ok\n") && !answer.contains("$N0"),
        "{answer}"
    );
    assert!(rig.slot.path.queue.is_empty() && place.is_some());
}

/// A line that waits for its moves is dropped too, and numbered lines begin anew.
#[test]
fn a_reprap_sender_hears_of_the_stop_without_a_greeting_and_may_begin_its_numbers_anew() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    rig.asked(&sender, "M110 N41\n");
    rig.asked(&sender, "G91\n");
    sender.say("G1 X-40 F3000\nM400\n");
    rig.until(|rig| rig.state() == State::Running);
    rig.answer(&sender);
    sender.say(RESET);
    rig.round();
    let answer = rig.answer(&sender);
    assert_eq!(
        answer,
        "Error:emergency stop, the bridges are off; M999 clears it\n"
    );
    let n1 = "N1 M105*38\n";
    let answer = rig.asked(&sender, n1);
    assert!(answer.starts_with("ok"), "{answer}");
    assert!(rig.asked(&sender, "M999\n").contains("ok\n"));
    assert_eq!(rig.state(), State::Stopped);
}

#[test]
fn the_shares_of_speed_are_whole_again_after_a_stop() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    sender.send(&[0x92, 0x97]);
    assert!(rig.report(&sender).contains("|Ov:90,25,100>"));
    sender.say(RESET);
    rig.round();
    assert!(rig.report(&sender).contains("|Ov:100,100,100>"));
}

#[test]
fn a_hold_during_homing_ends_it() {
    let mut rig = Rig::new();
    let sender = rig.connect();
    sender.say("$H\n");
    rig.until(|rig| rig.state() == State::Homing);
    assert!(rig.report(&sender).starts_with("<Home|"));
    sender.say("!");
    rig.round();
    rig.until(|rig| rig.state() != State::Homing);
    rig.until_rest();
    let answer = rig.answer(&sender);
    assert!(
        answer.contains("homing was stopped") && answer.ends_with("error:9\n"),
        "{answer}"
    );
    assert!(!rig.status().homed);
}
