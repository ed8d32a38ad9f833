//! Controllers over links without faults, with injected faults, and without reply.

use crate::arm::{self, driving, settings};
use fivebar_firmware::protocol::{HostCommand, Reply};
use fivebar_firmware::safety::{Fault, State};
use fivebar_firmware::{Move, MoveKind, Request};
use fivebar_kinematics::five_bar::Joint;
use fivebar_sim::link::{
    Client, FaultInjector, FaultRates, InProcess, LinkError, Lockstep, Loopback, Tracer,
};

fn lockstep() -> Loopback {
    Loopback::lockstep(&settings()).expect("valid settings")
}

#[test]
fn a_run_over_a_link_is_bit_identical_to_the_run_in_process() {
    let here = arm::run(&mut InProcess::new(&settings()).expect("valid settings"));
    assert!(here.faults.is_empty(), "{:?}", here.faults);
    assert!(here.ticks > 5000);

    let (mut there, _) =
        Lockstep::begin(lockstep(), &settings(), &settings()).expect("the link works");
    let record = arm::run(&mut there);
    assert_eq!(there.first_difference(), None);
    assert_eq!(there.ticks(), here.ticks);
    assert_eq!(record.tip_error, here.tip_error);
    assert_eq!(record.peak_torque, here.peak_torque);
}

#[test]
fn a_different_gain_is_found_by_the_first_difference_in_bits() {
    let mut other = settings();
    other.control.bandwidth *= 1.0001;
    let (mut there, _) = Lockstep::begin(lockstep(), &settings(), &other).expect("the link works");
    arm::run(&mut there);
    let difference = there.first_difference().expect("the runs differ");
    assert_eq!(difference.field, "current_demand", "{difference:?}");
    assert_ne!(difference.here, difference.there);
}

#[test]
fn injected_link_faults_do_not_change_the_run() {
    let one = |change: fn(&mut FaultRates)| {
        let mut rates = FaultRates::default();
        change(&mut rates);
        rates
    };
    let all = FaultRates {
        dropped: 0.01,
        repeated: 0.01,
        reordered: 0.01,
        corrupt: 0.01,
        garbage: 0.01,
    };
    let cases = [
        ("dropped", one(|m| m.dropped = 0.02)),
        ("repeated", one(|m| m.repeated = 0.05)),
        ("reordered", one(|m| m.reordered = 0.02)),
        ("corrupt", one(|m| m.corrupt = 0.02)),
        ("garbage", one(|m| m.garbage = 0.05)),
        ("all", all),
    ];
    for (seed, (name, rates)) in (1..).zip(cases) {
        let line = FaultInjector::new(lockstep(), rates, seed);
        let (mut there, _) =
            Lockstep::begin(line, &settings(), &settings()).expect("the link works");
        let record = arm::run(&mut there);
        assert_eq!(there.first_difference(), None, "{name}");
        assert!(record.faults.is_empty(), "{name}: {:?}", record.faults);
        let injected = there.client().line().injected();
        assert!(injected > 50, "{name}: only {injected} injected faults");
    }
}

#[test]
fn a_silent_controller_is_reported_with_advice() {
    let mut line = FaultInjector::new(lockstep(), FaultRates::default(), 1);
    line.cut_after(0);
    let error = Client::open(line).err().expect("no controller answers");
    assert!(matches!(error, LinkError::Silent));
    assert!(
        error.to_string().contains("check that it is powered"),
        "{error}"
    );
}

#[test]
fn the_arm_stops_on_its_path_if_the_host_falls_silent() {
    let line = FaultInjector::new(driving(), FaultRates::default(), 1);
    let (mut client, _) = Client::open(line).expect("the link works");
    let mut command = |command| {
        client
            .command(command)
            .expect("the link works")
            .expect("the command is accepted");
    };
    let theta = arm::plant();
    let angles = [theta.angle(Joint::Joint1), theta.angle(Joint::Joint4)].map(|angle| angle as f32);
    command(HostCommand::Request(Request::SetAngles(angles)));
    command(HostCommand::Request(Request::Arm));
    let [x, y] = arm::robot()
        .best_point()
        .expect("a reachable point")
        .map(|x| x as f32);
    command(HostCommand::Move(Move {
        tag: 1,
        tool: 0,
        kind: MoveKind::Line {
            to: [x, y],
            feed: 0.05,
        },
    }));
    // The arm moves, and the host sends no command for 0.3 s.
    for _ in 0..30 {
        client.poll().expect("the link works");
    }
    let (status, _) = client.status().expect("the link works");
    assert_eq!(status.state, State::Fault);
    assert_eq!(status.fault, Some(Fault::CommandTimeout));
    assert_eq!(status.missed_ticks, 0);
    let reply = client
        .call(HostCommand::Request(Request::Arm))
        .expect("the link works");
    assert!(matches!(reply, Reply::Refused(_)), "{reply:?}");
}

#[test]
fn a_tracer_records_both_directions() {
    let mut log = Vec::new();
    let line = Tracer::new(lockstep(), &mut log);
    let (mut client, _) = Client::open(line).expect("the link works");
    client.status().expect("the link works");
    drop(client);
    let log = String::from_utf8(log).expect("UTF-8 text");
    let lines: Vec<_> = log.lines().collect();
    assert_eq!(lines.len(), 4, "{log}");
    assert!(lines[0].starts_with("> HostMessage") && lines[0].contains("Hello"));
    assert!(lines[1].starts_with("< Reply") && lines[1].contains("Desktop"));
    assert!(lines[2].contains("command: Status"));
    assert!(lines[3].contains("state: Stopped"));
}
