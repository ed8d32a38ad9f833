//! Jobs that are streamed to a controller with its own clock and motors.

use crate::arm;
use fivebar_files::job::{DEMONSTRATION, Job, Stop};
use fivebar_files::scenario::Scenario;
use fivebar_firmware::protocol::{HostCommand, SectionKey};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Planner, Request};
use fivebar_sim::drive::{Drive, DriveError, Homing};
use fivebar_sim::link::{Client, Loopback};
use fivebar_sim::planned_time::{PlanStart, planned_times};
use fivebar_sim::time_optimal::JobPlanner;
use std::cell::Cell;

fn client() -> Client<Loopback> {
    Client::open(arm::driving()).expect("the link works").0
}

/// About two seconds of motion to and fro.
fn long_job() -> Vec<Move> {
    let [x, y] = arm::robot()
        .best_point()
        .expect("a reachable point")
        .map(|x| x as f32);
    (1..=40)
        .map(|tag| Move {
            tag,
            tool: 0,
            kind: MoveKind::Line {
                to: [x + 0.01 * (tag % 2) as f32, y],
                feed: 0.2,
            },
        })
        .collect()
}

#[test]
fn a_job_is_executed_completely_and_the_bridges_are_off_afterwards() {
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive
        .compare_settings(&arm::settings())
        .expect("equal settings");
    drive.home(Homing::IfUnknown).expect("homing succeeds");
    let mut most = 0;
    drive
        .follow(&long_job(), &arm::settings(), &mut |taken, _| most = taken)
        .expect("the job is executed");
    assert_eq!(most, 40);
    let (status, _) = client.status().expect("the link works");
    assert_eq!((status.state, status.fault), (State::Stopped, None));
    let [x, y] = arm::robot().best_point().expect("a reachable point");
    let [tool_x, tool_y] = status.tool.expect("the arm is homed").map(f64::from);
    assert!((tool_x - x).hypot(tool_y - y) < 5e-4, "{tool_x} {tool_y}");
}

/// The same job by timed moves, from where the arm is.
fn timed_job(drive: &mut Drive<'_, Client<Loopback>>) -> Vec<Move> {
    let mut planner = Planner::new(&arm::settings().check().expect("valid settings"));
    let job = JobPlanner::new(&arm::robot(), 0.7).expect("the robot has masses");
    let from = drive.tool().expect("the arm is homed");
    job.moves(from, &long_job(), &mut planner)
        .expect("the job is planned")
}

#[test]
fn a_time_optimal_job_is_executed_completely_and_can_be_stopped() {
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive.home(Homing::IfUnknown).expect("homing succeeds");
    let job = timed_job(&mut drive);
    let timed = |next: &&Move| matches!(next.kind, MoveKind::Timed(_));
    assert!(job.iter().filter(timed).count() > 100);
    drive
        .follow(&job, &arm::settings(), &mut |_, _| ())
        .expect("the job is executed");
    let [x, y] = arm::robot().best_point().expect("a reachable point");
    let [tool_x, tool_y] = drive.tool().expect("the arm is homed").map(f64::from);
    assert!((tool_x - x).hypot(tool_y - y) < 5e-4, "{tool_x} {tool_y}");

    let calls = Cell::new(0);
    let stop_requested = || {
        calls.set(calls.get() + 1);
        calls.get() > 60
    };
    let mut drive = Drive::new(&mut client, &stop_requested);
    let job = timed_job(&mut drive);
    let outcome = drive.follow(&job, &arm::settings(), &mut |_, _| ());
    let stopped = matches!(outcome, Err(DriveError::Stopped(Some(2..=39))));
    assert!(stopped, "{outcome:?}");
    let (status, _) = client.status().expect("the link works");
    assert_eq!((status.state, status.fault), (State::Stopped, None));
}

#[test]
fn a_job_rests_at_its_pauses_with_the_tool_up_until_it_may_go_on() {
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive.home(Homing::IfUnknown).expect("homing succeeds");
    let mut job = long_job();
    job.truncate(6);
    for next in &mut job {
        next.tool = FULL_TOOL;
    }
    let stopped = Job {
        stops: vec![Stop {
            line: 3,
            before: 3,
            code: "M0".into(),
            name: Some("red".into()),
        }],
        ..Job::default()
    };
    let (moves, pauses) = stopped.with_pauses(&job);
    let latest = Cell::new((0, None));
    let mut asked = 0;
    let outcome = drive.follow_with_pauses(
        &moves,
        &pauses,
        &arm::settings(),
        &mut |taken, status| latest.set((taken, Some(*status))),
        &mut |pause| {
            assert_eq!(pause.text, "M0: red");
            asked += 1;
            if asked > 20 {
                let (taken, Some(status)) = latest.get() else {
                    panic!("no status");
                };
                assert_eq!((taken, status.state), (4, State::Armed));
                assert_eq!(status.tool_level, 0.0);
            }
            Ok(asked > 100)
        },
    );
    outcome.expect("the job is executed");
    assert_eq!((asked, latest.get().0), (101, 7));
}

#[test]
fn a_request_to_stop_brings_the_arm_to_rest_and_removes_its_power() {
    let calls = Cell::new(0);
    let stop_requested = || {
        calls.set(calls.get() + 1);
        calls.get() > 120
    };
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive.home(Homing::IfUnknown).expect("homing succeeds");
    let mut drive = Drive::new(&mut client, &stop_requested);
    let outcome = drive.follow(&long_job(), &arm::settings(), &mut |_, _| ());
    let stopped = matches!(outcome, Err(DriveError::Stopped(Some(2..=39))));
    assert!(stopped, "{outcome:?}");
    let (status, _) = client.status().expect("the link works");
    assert_eq!((status.state, status.fault), (State::Stopped, None));
}

#[test]
fn an_infeasible_move_is_refused_before_the_arm_moves() {
    let mut job = long_job();
    job[39].kind = MoveKind::Line {
        to: [3.0, 0.0],
        feed: 0.1,
    };
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive.home(Homing::IfUnknown).expect("homing succeeds");
    let outcome = drive.follow(&job, &arm::settings(), &mut |_, _| panic!("the arm moves"));
    match outcome {
        Err(DriveError::Move(refusal)) => {
            assert_eq!(refusal.tag, 40);
            assert!(refusal.point.is_some(), "{refusal}");
        }
        other => panic!("{other:?}"),
    }
    let (status, _) = client.status().expect("the link works");
    assert_eq!(status.state, State::Stopped);
}

#[test]
fn different_settings_are_refused_until_they_are_uploaded() {
    let mut other = arm::settings();
    other.payload += 0.01;
    other.axes[1].gear_ratio += 1.0;
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    match drive.compare_settings(&other) {
        Err(DriveError::OtherSettings(differing)) => {
            assert_eq!(differing, [SectionKey::Payload, SectionKey::Axis(1)]);
        }
        outcome => panic!("{outcome:?}"),
    }
    drive.store_settings(&other).expect("the upload succeeds");
    drive.compare_settings(&other).expect("equal settings");
    assert_eq!(client.line().saved(), Some(&other));
}

#[test]
fn a_latched_fault_is_reported_and_prevents_motion_until_it_is_cleared() {
    let mut client = client();
    let stop = HostCommand::Request(Request::EmergencyStop);
    client
        .command(stop)
        .expect("the link works")
        .expect("the command is accepted");
    client.poll().expect("the link works");
    let mut drive = Drive::new(&mut client, &|| false);
    let outcome = drive.home(Homing::IfUnknown);
    let Err(error @ DriveError::Fault(Fault::EmergencyStop)) = outcome else {
        panic!("{outcome:?}");
    };
    assert!(
        error.to_string().contains("fault 10, emergency stop"),
        "{error}"
    );
    drive.clear_fault().expect("the fault is cleared");
    drive.home(Homing::IfUnknown).expect("homing succeeds");
}

/// The time that a job takes [s]: planned before, then driven.
fn times_of(moves: &[Move], drive: &mut Drive<'_, Client<Loopback>>) -> [f64; 2] {
    let settings = arm::settings();
    let start = PlanStart {
        tool: drive.tool().expect("the arm is homed"),
        mode: settings.working_mode(),
        assembly: settings.assembly(),
    };
    let planned = planned_times(&settings, start, moves, &|| true).expect("the job is planned");
    assert!(planned.is_sorted(), "{planned:?}");
    let mut running = Vec::new();
    drive
        .follow(moves, &settings, &mut |_, status| {
            if status.state == State::Running {
                running.push(status.tick);
            }
        })
        .expect("the job is executed");
    let ticks = running[running.len() - 1] - running[0];
    let tick_rate = f64::from(settings.control.tick_rate);
    [planned[planned.len() - 1], f64::from(ticks) / tick_rate]
}

/// The status is read every 10 ms, so a time is known within 20 ms.
#[test]
fn the_planned_time_of_a_job_is_that_of_its_run() {
    let mut client = client();
    let mut drive = Drive::new(&mut client, &|| false);
    drive.home(Homing::IfUnknown).expect("homing succeeds");
    let zigzag: String = (0..100)
        .map(|i| format!("G1 X{} Y{}\n", 0.05 * f64::from(i), i % 2))
        .collect();
    let circles = "G2 X10 Y0 I5 J0\nG2 X0 Y0 I-5 J0\n".repeat(4);
    let fine: String = (0..3000)
        .map(|i| f64::from(i) / 100.0)
        .map(|turn| {
            format!(
                "G1 X{:.4} Y{:.4}\n",
                8.0 * turn.sin(),
                5.0 * (3.0 * turn).cos()
            )
        })
        .collect();
    let jobs = [
        DEMONSTRATION.to_string(),
        format!("G21 G90 F3000\nM3\n{zigzag}G4 P200\nM5\nG0 X0 Y0\n"),
        format!("G21 G90 F1200\nM3\n{circles}"),
        format!("G21 G90 F6000\nM3\n{fine}"),
    ];
    for text in jobs {
        let scenario = Scenario::new("job", arm::robot(), "job.gcode", text);
        let job = scenario.job().expect("the job is read");
        let moves = scenario.moves(&job).expect("the job has moves");
        let [planned, took] = times_of(&moves, &mut drive);
        assert!(
            (took - planned).abs() < 0.025,
            "planned {planned} s, took {took} s"
        );
    }
    let timed = timed_job(&mut drive);
    let [planned, took] = times_of(&timed, &mut drive);
    assert!(
        (took - planned).abs() < 0.02,
        "planned {planned} s, took {took} s"
    );
}
