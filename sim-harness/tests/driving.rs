//! Jobs streamed to a controller that drives motors.

mod arm;

use fivebar::run::drive::{Drive, DriveError, Homing};
use fivebar::run::link::{Client, Loopback};
use fivebar_firmware::protocol::{Order, SectionKey};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, MoveKind, Request};
use std::cell::Cell;

fn client() -> Client<Loopback> {
    Client::open(arm::driving()).expect("a line").0
}

/// Two seconds of going to and fro.
fn long_job() -> Vec<Move> {
    let [x, y] = arm::robot()
        .best_point()
        .expect("a point")
        .map(|x| x as f32);
    (1..=40)
        .map(|tag| Move {
            tag,
            kind: MoveKind::Line {
                to: [x + 0.01 * (tag % 2) as f32, y],
                feed: 0.2,
            },
        })
        .collect()
}

#[test]
fn a_job_is_done_whole_and_the_bridges_are_off_afterwards() {
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive
        .agree_on(&arm::settings(), false)
        .expect("the same settings");
    drive.home(Homing::Switches).expect("the switches work");
    let mut most = 0;
    drive
        .follow(&long_job(), &arm::settings(), &mut |taken, _| most = taken)
        .expect("the job can be done");
    assert_eq!(most, 40);
    let (status, _) = client.status().expect("a line");
    assert_eq!((status.state, status.fault), (State::Stopped, None));
    let [x, y] = arm::robot().best_point().expect("a point");
    let [tool_x, tool_y] = status.tool.expect("homed").map(f64::from);
    assert!((tool_x - x).hypot(tool_y - y) < 5e-4, "{tool_x} {tool_y}");
}

#[test]
fn a_wish_to_stop_brings_the_arm_to_rest_and_unpowers_it() {
    let asked = Cell::new(0);
    let wants_stop = || {
        asked.set(asked.get() + 1);
        asked.get() > 120
    };
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive.home(Homing::Switches).expect("the switches work");
    let mut drive = Drive::new(&mut client, &wants_stop);
    let outcome = drive.follow(&long_job(), &arm::settings(), &mut |_, _| ());
    let stopped = matches!(outcome, Err(DriveError::Stopped(Some(2..=39))));
    assert!(stopped, "{outcome:?}");
    let (status, _) = client.status().expect("a line");
    assert_eq!((status.state, status.fault), (State::Stopped, None));
}

#[test]
fn a_move_that_cannot_be_done_is_refused_before_anything_moves() {
    let mut job = long_job();
    job[39].kind = MoveKind::Line {
        to: [3.0, 0.0],
        feed: 0.1,
    };
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive.home(Homing::Switches).expect("the switches work");
    let outcome = drive.follow(&job, &arm::settings(), &mut |_, _| panic!("it moves"));
    match outcome {
        Err(DriveError::Move(refusal)) => {
            assert_eq!(refusal.tag, 40);
            assert!(refusal.point.is_some(), "{refusal}");
        }
        other => panic!("{other:?}"),
    }
    let (status, _) = client.status().expect("a line");
    assert_eq!(status.state, State::Stopped);
}

#[test]
fn another_arms_settings_are_refused_until_they_are_uploaded() {
    let mut other = arm::settings();
    other.payload += 0.01;
    other.axes[1].gear_ratio += 1.0;
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    match drive.agree_on(&other, false) {
        Err(DriveError::OtherSettings(differing)) => {
            assert_eq!(differing, [SectionKey::Payload, SectionKey::Axis(1)]);
        }
        outcome => panic!("{outcome:?}"),
    }
    drive.agree_on(&other, true).expect("an upload");
    drive.agree_on(&other, false).expect("the same settings");
    assert_eq!(client.line().saved(), Some(&other));
}

#[test]
fn a_latched_fault_is_told_and_keeps_the_arm_still_until_cleared() {
    let mut client = client();
    let stop = Order::Request(Request::EmergencyStop);
    client.command(stop).expect("a line").expect("obeyed");
    client.poll().expect("a line");
    let mut drive = Drive::new(&mut client, &|| false);
    let outcome = drive.home(Homing::Switches);
    let Err(error @ DriveError::Fault(Fault::EmergencyStop)) = outcome else {
        panic!("{outcome:?}");
    };
    assert!(
        error.to_string().contains("fault 10, emergency stop"),
        "{error}"
    );
    drive.clear_fault().expect("it can be cleared");
    drive.home(Homing::Switches).expect("the switches work");
}
