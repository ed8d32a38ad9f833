//! The end of a session with a controller.

use fivebar_files::robot::Robot;
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::safety::State;
use fivebar_firmware::{Move, MoveKind, Request};
use fivebar_sim::controller::{ControllerSource, Session, open};
use std::time::{Duration, Instant};

/// Passes time until the status is as wanted.
fn wait(session: &mut Session, wanted: impl Fn(&Session) -> bool) {
    let start = Instant::now();
    loop {
        session.read_status().unwrap();
        if wanted(session) {
            return;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "it takes long");
        session.pass_time().unwrap();
    }
}

#[test]
fn a_session_that_ends_while_the_arm_moves_leaves_it_at_rest_with_the_bridges_off() {
    let robot = Robot::load("benchtop").unwrap();
    let (mut session, place) = open(&robot, ControllerSource::Simulated).unwrap();
    assert!(place == "simulated" && !session.is_in_lockstep());
    let refusal = session.request(Request::Arm).unwrap().unwrap_err();
    assert_eq!(refusal, "The joint angles are unknown: home first.");
    session.request(Request::Home).unwrap().unwrap();
    wait(&mut session, |session| session.status.homed);
    session.wait_until_off().unwrap();
    session.request(Request::Arm).unwrap().unwrap();
    wait(&mut session, |session| session.status.reference.is_some());
    let [x, y] = session.status.reference.unwrap();
    let kind = MoveKind::Line {
        to: [x + 0.03, y],
        feed: 0.1,
    };
    let next = Move {
        tag: 1,
        tool: 0,
        kind,
    };
    let reply = session.client.call(HostCommand::Move(next)).unwrap();
    assert!(matches!(reply, Reply::Taken { .. }), "{reply:?}");
    wait(&mut session, |session| {
        session.status.velocity.iter().any(|rate| rate.abs() > 0.2)
    });
    session.stop_arm().unwrap();
    // On a busy machine the controller may have stopped the arm before, with a fault.
    let state = session.status.state;
    assert!(matches!(state, State::Stopped | State::Fault), "{state:?}");
}
