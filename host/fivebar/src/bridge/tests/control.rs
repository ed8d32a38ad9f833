//! Which sender is in control, and what becomes of one that falls silent, leaves or floods.

use super::rig::{Caller, Rig};
use crate::bridge::slot::Phase;
use fivebar_firmware::safety::State;
use std::sync::Arc;
use std::time::Duration;

const BUSY: &str = "[MSG:another sender is in control: disconnect it first]\nerror:9\n";
/// More than the 10 s after which a silent sender may lose control.
const LONG: Duration = Duration::from_secs(11);

/// A second sender; whether it gets control in place of the first.
fn takes_over(rig: &mut Rig, first: &Caller) -> bool {
    let second = rig.call();
    rig.round();
    let sender = rig.slot.sender.as_ref().unwrap();
    if Arc::ptr_eq(&sender.outlet.presence, &first.presence) {
        assert_eq!(second.refusal(), BUSY);
        return false;
    }
    let received = first.refusal();
    assert!(
        received.ends_with("[MSG:another sender is in control now, because this one was silent]\n"),
        "{received}"
    );
    true
}

#[test]
fn a_sender_is_refused_while_a_page_moves_the_arm() {
    let mut rig = Rig::new();
    rig.slot.admits = false;
    let sender = rig.call();
    rig.round();
    assert_eq!(
        sender.refusal(),
        "[MSG:the live page moves the arm: connect when it rests]\nerror:9\n"
    );
    assert!(rig.slot.sender.is_none());
}

#[test]
fn only_a_silent_sender_loses_control_to_another_one() {
    let mut rig = Rig::homed();
    let first = rig.connect();
    assert!(!takes_over(&mut rig, &first));
    first.be_silent(LONG);
    assert!(takes_over(&mut rig, &first));
    rig.note();
    assert_eq!(
        rig.note().as_deref(),
        Some("a test was silent and loses control to another sender")
    );
}

#[test]
fn a_silent_sender_keeps_control_while_its_arm_moves() {
    let mut rig = Rig::homed();
    let first = rig.drawing();
    first.be_silent(LONG);
    assert!(!takes_over(&mut rig, &first));
    assert_eq!(rig.state(), State::Running);
}

#[test]
fn a_silent_sender_keeps_control_while_its_arm_homes_and_while_it_comes_to_rest() {
    let mut rig = Rig::new();
    let first = rig.connect();
    first.say("$H\n");
    rig.until(|rig| rig.state() == State::Homing);
    first.be_silent(LONG);
    assert!(!takes_over(&mut rig, &first));
    let mut rig = Rig::homed();
    let first = rig.drawing();
    first.say("!");
    rig.round();
    assert!(matches!(rig.slot.phase, Phase::Holding { .. }));
    first.be_silent(LONG);
    assert!(!takes_over(&mut rig, &first));
}

#[test]
fn a_silent_sender_keeps_control_while_a_line_waits_although_the_arm_rests() {
    let mut rig = Rig::homed();
    let first = rig.connect();
    first.say("G91 G1 X-1 F3000\n");
    first.be_silent(LONG);
    // Both are in the queue of events when the slot looks there.
    assert!(!takes_over(&mut rig, &first));
}

#[test]
fn a_silent_sender_loses_control_in_a_pause_and_its_path_is_dropped() {
    let mut rig = Rig::homed();
    let first = rig.drawing();
    first.say("!");
    rig.until(|rig| rig.slot.phase == Phase::Held);
    assert!(!takes_over(&mut rig, &first));
    first.be_silent(LONG);
    assert!(takes_over(&mut rig, &first));
    assert!(rig.slot.path.queue.is_empty());
    assert_eq!(rig.slot.phase, Phase::Ready);
    for _ in 0..20 {
        rig.round();
        assert_eq!(rig.state(), State::Armed);
    }
}

/// The second one gets control only when the arm rests.
#[test]
fn a_lost_senders_arm_comes_to_rest_and_its_lines_are_dropped() {
    let mut rig = Rig::homed();
    let first = rig.drawing();
    let begun = rig.status().tool.unwrap();
    first.say("G1 X40\nG1 X-40\n");
    rig.note();
    first.hang_up();
    let second = rig.call();
    rig.round();
    assert_eq!(second.refusal(), BUSY);
    rig.until(|rig| rig.slot.sender.is_none());
    assert_eq!(rig.state(), State::Armed);
    assert_eq!(
        rig.note().as_deref(),
        Some("the sender has closed the connection; the arm rests")
    );
    let [x, _] = rig.status().tool.unwrap();
    assert!((x - begun[0]).abs() < 0.03, "it stopped {begun:?} → {x}");
    let third = rig.connect();
    assert!(rig.report(&third).starts_with("<Idle|"));
    assert!(rig.rests());
}

/// What a sender has sent before it left does not move the arm.
#[test]
fn lines_of_a_sender_that_has_left_are_not_begun() {
    let mut rig = Rig::homed();
    let first = rig.connect();
    first.say("G91 G1 X-40 F3000\n");
    first.hang_up();
    for _ in 0..20 {
        rig.round();
        assert_eq!(rig.state(), State::Stopped);
    }
    assert!(rig.slot.sender.is_none());
}

#[test]
fn a_sender_that_waits_for_no_answers_is_disconnected_once_with_a_note() {
    let mut rig = Rig::homed();
    let first = rig.drawing();
    rig.note();
    let line = format!("({})\n", "a".repeat(509));
    for _ in 0..128 {
        first.say(&line);
    }
    rig.slot.take_events(&mut rig.session).unwrap();
    assert!(!first.is_closed(), "65,536 bytes may wait");
    first.say("\n");
    rig.slot.take_events(&mut rig.session).unwrap();
    assert!(first.is_closed());
    first.say("\n");
    rig.slot.take_events(&mut rig.session).unwrap();
    let note = "the sender waits for no answers and is disconnected";
    assert_eq!(rig.note().as_deref(), Some(note));
    assert_eq!(rig.note(), None);
}

#[test]
fn a_sender_that_asks_for_more_reports_than_it_can_read_is_disconnected() {
    let mut rig = Rig::homed();
    let first = rig.connect();
    first.say(&"?".repeat(1000));
    rig.round();
    let answer = rig.answer(&first);
    assert_eq!(answer.matches("<Idle|").count(), 1, "one answers all");
    first.say(&"?".repeat(1000));
    first.say("?");
    assert_eq!(first.presence.ended(), None);
    // The connection ends while it reads this.
    first.say_last("?");
    let why = "the sender sends faster than it is served, and is disconnected";
    assert_eq!(first.presence.ended(), Some(why));
    rig.until(|rig| rig.slot.sender.is_none());
}

#[test]
fn silence_is_the_time_since_the_latest_byte() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    assert!(sender.presence.silence() < Duration::from_secs(30));
    sender.be_silent(LONG);
    assert!(sender.presence.silence() >= LONG);
    sender.say("?");
    assert!(sender.presence.silence() < LONG);
}
