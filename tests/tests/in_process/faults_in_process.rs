//! Every fault injected by `docs/verify/data/injected_faults.csv` with a controller in this process.

use crate::bench::{self, Bench, is_off, stated};
use fivebar_firmware::Request;
use fivebar_firmware::controller;
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply, Reset, VERSION};
use fivebar_firmware::safety::{Fault, State};
use fivebar_sim::link::Loopback;

fn line() -> Loopback {
    Loopback::lockstep(&bench::robot().settings().expect("masses")).expect("valid settings")
}

crate::injected_faults::test_every_injected_fault!(line);

#[test]
fn a_reset_by_the_watchdog_in_motion() {
    let stated = stated("a_reset_by_the_watchdog_in_motion");
    latches_after(Reset::Watchdog, stated.fault);
}

#[test]
fn every_reset_in_motion_but_power_up_latches_its_cause() {
    for (reset, fault) in [
        (Reset::Panic, Fault::Panic),
        (Reset::HardFault, Fault::HardFault),
        (Reset::BrownOut, Fault::BrownOut),
        (Reset::Software, Fault::UnexpectedReset),
        (Reset::Pin, Fault::UnexpectedReset),
        (Reset::Unknown, Fault::UnexpectedReset),
    ] {
        latches_after(reset, fault);
    }
}

/// The controller is reset while the arm moves: it starts with the bridges off and the fault
/// latched, without a session and not homed.
fn latches_after(reset: Reset, fault: Fault) {
    let mut bench = Bench::moving(line());
    let board = bench.board.line().line();
    board.restart(reset).expect("valid settings");
    let mut ask = |command| bench.board.call(command).expect("an answer");
    let sample = bench.plant.sense();
    let stranger = Reply::Refused(CommandError::NoSession);
    assert_eq!(ask(HostCommand::Tick(sample)), stranger);
    let session = 99;
    let version = VERSION;
    let Reply::Hello(identity) = ask(HostCommand::Hello { version, session }) else {
        panic!("no hello");
    };
    assert_eq!(identity.reset, reset);
    for _ in 0..50 {
        let Reply::StepResult(result) = ask(HostCommand::Tick(bench.plant.sense())) else {
            panic!("no tick");
        };
        assert_eq!((result.state, result.fault), (State::Fault, Some(fault)));
        is_off(&result);
        bench.plant.step(&result.command, 1e-4);
        for request in [Request::Arm, Request::Home] {
            let reply = ask(HostCommand::Request(request));
            let state = controller::RequestError::State(State::Fault);
            assert_eq!(reply, Reply::Refused(CommandError::Request(state)));
        }
    }
    assert_eq!(ask(HostCommand::Request(Request::ClearFault)), Reply::Done);
    let unknown = Reply::Refused(CommandError::Request(controller::RequestError::NotHomed));
    assert_eq!(ask(HostCommand::Request(Request::Arm)), unknown);
}
