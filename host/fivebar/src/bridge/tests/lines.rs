//! Lines in order: what each does, when it is answered, and what a pause, a jog and a report make of it.

use super::rig::Rig;
use crate::bridge::path_state::PathState;
use crate::bridge::protocol::Order;
use crate::bridge::slot::Phase;
use crate::test_session;
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, MoveKind, Request};
use std::time::Duration;

/// The tool's X [mm].
fn x(rig: &Rig) -> f64 {
    1e3 * f64::from(rig.status().tool.unwrap()[0])
}

#[test]
fn a_sender_homes_its_arm_and_then_may_move_it() {
    let mut rig = Rig::new();
    let sender = rig.connect();
    assert!(rig.report(&sender).starts_with("<Alarm|"));
    let answer = rig.asked(&sender, "G91 G1 X-5 F3000\n");
    assert!(answer.contains("home first") && answer.ends_with("error:9\n"));
    sender.say("$H\n");
    rig.round();
    assert!(rig.report(&sender).starts_with("<Home|"));
    rig.until_rest();
    assert_eq!(rig.answer(&sender), "ok\n");
    assert_eq!((rig.state(), rig.status().homed), (State::Stopped, true));
    let start = x(&rig);
    assert_eq!(rig.asked(&sender, "G91 G1 X-5 F3000\n"), "ok\n");
    rig.until(|rig| rig.state() == State::Armed && rig.rests());
    assert!((x(&rig) - start + 5.0).abs() < 0.2, "{start} {}", x(&rig));
    assert!(rig.report(&sender).starts_with("<Idle|MPos:-"));
}

#[test]
fn homing_that_somebody_else_ends_has_failed_and_can_be_repeated() {
    let mut rig = Rig::new();
    let sender = rig.connect();
    sender.say("$H\n");
    rig.until(|rig| rig.state() == State::Homing);
    rig.session.request(Request::Stop).unwrap().unwrap();
    rig.until_rest();
    let answer = rig.answer(&sender);
    assert_eq!(answer, "[MSG:homing has failed]\nerror:9\n");
    assert_eq!(rig.asked(&sender, "$H\n"), "ok\n");
    assert!(rig.status().homed);
}

/// Homing begins with the bridges off, and after all moves.
#[test]
fn an_armed_arm_is_switched_off_before_it_homes_again() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    sender.say("G91 G1 X-5 F3000\n");
    rig.until(|rig| rig.state() == State::Running);
    rig.answer(&sender);
    sender.say("$H\n");
    rig.round();
    assert_eq!(rig.state(), State::Running, "the move comes first");
    rig.until(|rig| rig.state() == State::Homing);
    rig.until_rest();
    assert_eq!(rig.answer(&sender), "ok\n");
    assert!(rig.status().homed && rig.state() == State::Stopped);
    assert_eq!(rig.asked(&sender, "G91 G1 X-5\n"), "ok\n");
}

#[test]
fn a_line_is_answered_while_its_moves_wait_and_further_ones_when_there_is_room() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    sender.say("G91 G1 X-0.5 F600\n");
    rig.round();
    assert_eq!(rig.answer(&sender), "ok\n");
    let free = rig.slot.path.free;
    sender.say(&"X-0.5\n".repeat(100));
    for _ in 0..3 {
        rig.round();
        assert!(rig.slot.path.queue.waiting() <= 16);
    }
    let answers = rig.answer(&sender).matches("ok").count();
    // 16 wait, and the controller has as many as its queue takes; the rest wait as lines.
    assert!((16..100).contains(&answers), "{answers} of {free}");
    assert!(rig.report(&sender).contains("<Run|"));
    let start = x(&rig);
    rig.until_rest();
    assert_eq!(rig.answer(&sender).matches("ok").count(), 100 - answers);
    assert!(x(&rig) < start - 30.0);
}

/// It is answered when there is room for the next one.
#[test]
fn a_line_after_which_sixteen_moves_wait_is_not_answered_yet() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    sender.say(&format!("G91 G1 X-0.5 F600\n{}", "X-0.5\n".repeat(60)));
    for _ in 0..4 {
        rig.slot.serve_sender(&mut rig.session).unwrap();
    }
    assert!(rig.slot.path.queue.waiting() >= 16);
    let sender = rig.slot.sender.as_ref().unwrap();
    let (_, response) = sender.current.as_ref().expect("a line in progress");
    assert_eq!(response.orders, [Order::Accepted]);
}

#[test]
fn a_path_is_done_when_the_controller_has_no_moves_in_two_ticks() {
    let mut status = test_session::session().status;
    status.state = State::Armed;
    let mut path = PathState::new(13);
    let mut is_idle = |free, state, tick| {
        path.free = free;
        (status.state, status.tick) = (state, tick);
        path.is_idle(&status)
    };
    assert!(!is_idle(13, State::Armed, 5) && !is_idle(13, State::Armed, 5));
    assert!(is_idle(13, State::Armed, 6) && is_idle(13, State::Armed, 7));
    assert!(!is_idle(12, State::Armed, 8) && !is_idle(13, State::Armed, 9));
    assert!(!is_idle(13, State::Running, 10) && !is_idle(13, State::Armed, 11));
    assert!(is_idle(13, State::Armed, 12));
}

#[test]
fn a_target_out_of_reach_is_refused_and_moves_nothing() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    let answer = rig.asked(&sender, "G90 G1 X-4000 F3000\n");
    assert!(answer.ends_with("error:15\n"), "{answer}");
    assert_eq!(rig.state(), State::Stopped, "it is not even armed");
    assert_eq!(rig.asked(&sender, "G91 G1 X-1 F3000\n"), "ok\n");
}

#[test]
fn m84_switches_off_at_the_end_of_the_path() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    rig.asked(&sender, "M115\n");
    assert_eq!(rig.asked(&sender, "M84\n"), "ok\n", "nothing to switch off");
    sender.say("G91\nG1 X-10 F3000\nM84\n");
    rig.until(|rig| rig.state() == State::Running);
    rig.round();
    assert_eq!(rig.state(), State::Running);
    rig.until_rest();
    rig.round();
    assert_eq!(rig.state(), State::Stopped);
    assert_eq!(rig.answer(&sender).matches("ok\n").count(), 3);
}

#[test]
fn m84_under_a_fault_finds_the_bridges_off() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    rig.asked(&sender, "M115\n");
    sender.say("M112\n");
    rig.until(|rig| rig.state() == State::Fault);
    rig.answer(&sender);
    assert_eq!(rig.asked(&sender, "M84\n"), "ok\n");
}

#[test]
fn a_program_pause_waits_for_the_user_at_rest() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    sender.say("M0\nG1 X-5\n");
    rig.round();
    assert!(rig.answer(&sender).contains("waits for ~ or M108"));
    assert_eq!(
        rig.state(),
        State::Running,
        "the pause comes after the move"
    );
    rig.until(|rig| rig.slot.phase == Phase::Held);
    assert!(rig.report(&sender).starts_with("<Hold:0|"));
    for _ in 0..20 {
        rig.round();
        assert_eq!(rig.state(), State::Armed);
    }
    assert!(!rig.answer(&sender).contains("ok"));
    sender.say("~");
    rig.until(|rig| rig.state() == State::Running);
    rig.until_rest();
    assert_eq!(rig.answer(&sender), "ok\nok\n");
}

#[test]
fn a_hold_rests_on_the_path_which_goes_on_when_the_user_says_so() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    let start = rig.status().reference.unwrap()[0];
    sender.say("!");
    rig.round();
    assert!(rig.report(&sender).starts_with("<Hold:1|"));
    rig.until(|rig| rig.slot.phase == Phase::Held);
    assert!(rig.report(&sender).starts_with("<Hold:0|"));
    let (held, waiting) = (x(&rig), rig.slot.path.queue.waiting());
    rig.answer(&sender);
    sender.say("G1 X-0.1\n");
    for _ in 0..50 {
        rig.round();
        assert_eq!(rig.state(), State::Armed);
    }
    assert!((x(&rig) - held).abs() < 0.1);
    // A line that comes meanwhile waits, too.
    assert_eq!(rig.slot.path.queue.waiting(), waiting);
    assert_eq!(rig.answer(&sender), "");
    sender.say("~");
    rig.until_rest();
    let end = f64::from(rig.status().reference.unwrap()[0] - start);
    assert!(
        (end + 0.0401).abs() < 2e-3,
        "the whole line is drawn: {end}"
    );
    assert_eq!(rig.answer(&sender), "ok\n");
}

/// The controller refuses what waits; the sender hears why, and may begin anew.
#[test]
fn a_path_whose_arm_somebody_else_has_switched_off_in_a_hold_is_dropped() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    sender.say("!");
    rig.until(|rig| rig.slot.phase == Phase::Held);
    rig.session.request(Request::Disarm).unwrap().unwrap();
    rig.session.wait_until_off().unwrap();
    rig.answer(&sender);
    sender.say("~");
    rig.round();
    let answer = rig.answer(&sender);
    assert!(answer.starts_with("[MSG:"), "{answer}");
    assert!(rig.slot.path.queue.is_empty());
    assert_eq!(rig.asked(&sender, "G91 G1 X-1\n"), "ok\n");
}

#[test]
fn a_user_who_says_go_on_before_the_arm_rests_need_not_say_it_again() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    sender.say("!");
    rig.round();
    assert!(matches!(
        rig.slot.phase,
        Phase::Holding { goes_on: false, .. }
    ));
    sender.say("~");
    rig.round();
    rig.until(|rig| rig.slot.phase == Phase::Ready);
    rig.until_rest();
    assert!(rig.report(&sender).starts_with("<Idle|"));
}

/// Nothing follows: the phases in which a hold or a way out of one has no meaning.
#[test]
fn a_second_hold_and_a_resume_without_one_change_nothing() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    sender.say("~");
    rig.round();
    assert_eq!(rig.slot.phase, Phase::Ready);
    sender.say("!!");
    rig.until(|rig| rig.slot.phase == Phase::Held);
    sender.say("!");
    rig.round();
    assert_eq!(rig.slot.phase, Phase::Held);
    sender.say("~");
    rig.until_rest();
}

#[test]
fn a_jog_ends_when_it_is_cancelled_or_held_and_its_rest_is_dropped() {
    for end in [0x85, b'!'] {
        let mut rig = Rig::homed();
        let sender = rig.connect();
        sender.say("$J=G91 X-40 F3000\n");
        rig.until(|rig| rig.state() == State::Running);
        assert!(rig.report(&sender).starts_with("<Jog|"));
        let start = x(&rig);
        sender.send(&[end]);
        rig.round();
        rig.until(|rig| rig.rests() && !rig.slot.path.is_jog);
        assert!(x(&rig) > start - 20.0, "{start} → {}", x(&rig));
        assert!(rig.report(&sender).starts_with("<Idle|"));
        // The next line begins where the arm has come to rest.
        let rest = x(&rig);
        assert_eq!(rig.asked(&sender, "G91 G1 X-1 F3000\n"), "ok\n");
        rig.until(|rig| rig.state() == State::Armed);
        assert!((x(&rig) - rest + 1.0).abs() < 0.2, "{rest} → {}", x(&rig));
    }
}

#[test]
fn a_jog_that_is_done_is_no_jog_any_more_and_its_cancelling_stops_no_line() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    assert_eq!(rig.asked(&sender, "$J=G91 X-5 F3000\n"), "ok\n");
    rig.until(|rig| rig.state() == State::Armed);
    rig.round();
    assert!(!rig.slot.path.is_jog);
    sender.say("G91 G1 X-20 F3000\n");
    rig.until(|rig| rig.state() == State::Running);
    let report = rig.report(&sender);
    assert!(report.starts_with("<Run|"), "{report}");
    sender.send(&[0x85]);
    rig.round();
    assert_eq!(rig.state(), State::Running);
    rig.until_rest();
}

/// With the bridges off the arm may be moved by hand: the next line begins where it is.
#[test]
fn unlocking_without_a_fault_does_nothing() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    assert!(rig.asked(&sender, "$X\n").ends_with("ok\n"));
    assert_eq!(rig.state(), State::Stopped);
}

#[test]
fn a_slow_line_of_a_reprap_sender_is_said_to_be_in_progress() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    rig.asked(&sender, "M115\n");
    sender.say("G91\nG1 X-30 F300\nM400\n");
    rig.until(|rig| rig.state() == State::Running);
    for (passed, signs) in [(0, 0), (3, 1)] {
        rig.answer(&sender);
        rig.session.clock.sleep(Duration::from_secs(passed));
        rig.round();
        let answer = rig.answer(&sender);
        assert_eq!(answer, "echo:busy: processing\n".repeat(signs));
    }
}

#[test]
fn a_grbl_sender_is_not_told_that_a_line_is_in_progress() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    sender.say("M0\n");
    rig.round();
    rig.session.clock.sleep(Duration::from_secs(3));
    rig.round();
    let answer = rig.answer(&sender);
    assert!(!answer.contains("busy"), "{answer}");
}

/// By a page, say.
#[test]
fn an_arm_that_somebody_else_moves_is_seen_to_run_and_its_silent_sender_keeps_it() {
    let mut rig = Rig::homed();
    let sender = rig.connect();
    rig.asked(&sender, "G91 G1 X-1 F3000\n");
    rig.until(|rig| rig.state() == State::Armed);
    let [x, y] = rig.status().reference.unwrap();
    let (to, feed) = ([x - 0.03, y], 0.05);
    let (tag, tool, kind) = (0, 0, MoveKind::Line { to, feed });
    let next = HostCommand::Move(Move { tag, tool, kind });
    let taken = rig.session.client.call(next).unwrap();
    assert!(matches!(taken, Reply::Taken { .. }), "{taken:?}");
    rig.round();
    rig.round();
    assert!(rig.report(&sender).starts_with("<Run|"));
    sender.be_silent(Duration::from_secs(11));
    let other = rig.call();
    rig.round();
    assert!(other.refusal().contains("another sender is in control"));
}

#[test]
fn a_report_shows_the_speed_of_the_tool() {
    let mut rig = Rig::homed();
    let sender = rig.drawing();
    for _ in 0..20 {
        rig.round();
    }
    let report = rig.report(&sender);
    let (_, speed) = report.split_once("|FS:").unwrap();
    let speed: f64 = speed.split(',').next().unwrap().parse().unwrap();
    assert!((speed - 3000.0).abs() < 30.0, "{report}");
    rig.until_rest();
    rig.round();
    assert!(rig.report(&sender).contains("|FS:0,0|"));
}
