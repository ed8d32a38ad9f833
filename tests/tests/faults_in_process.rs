//! Every mishap of `docs/faults.md` with a controller in this process.

mod bench;
mod mishaps;

use bench::{Bench, is_off, stated};
use fivebar::run::link::Loopback;
use fivebar_firmware::Request;
use fivebar_firmware::controller;
use fivebar_firmware::protocol::{Order, Refusal, Reply, Reset, VERSION};
use fivebar_firmware::safety::State;

fn line() -> Loopback {
    Loopback::lockstep(&bench::robot().settings().expect("masses")).expect("sound settings")
}

mishaps::test_every_mishap!(line);

/// The watchdog resets the controller while the arm moves: it comes up unpowered with the
/// fault latched, and knows neither the host nor where the arm is.
#[test]
fn a_reset_by_the_watchdog_in_motion() {
    let stated = stated("a_reset_by_the_watchdog_in_motion");
    let mut bench = Bench::moving(line());
    let board = bench.board.line().line();
    board.restart(Reset::Watchdog).expect("sound settings");
    let mut ask = |order| bench.board.call(order).expect("an answer");
    let sensed = bench.plant.sense();
    let stranger = Reply::Refused(Refusal::NoSession);
    assert_eq!(ask(Order::Tick(sensed)), stranger);
    let session = 99;
    let version = VERSION;
    let Reply::Hello(identity) = ask(Order::Hello { version, session }) else {
        panic!("no hello");
    };
    assert_eq!(identity.reset, Reset::Watchdog);
    for _ in 0..50 {
        let Reply::Ticked(ticked) = ask(Order::Tick(bench.plant.sense())) else {
            panic!("no tick");
        };
        assert_eq!(
            (ticked.state, ticked.fault),
            (State::Fault, Some(stated.fault))
        );
        is_off(&ticked);
        bench.plant.step(&ticked.command, 1e-4);
        for request in [Request::Arm, Request::Home] {
            let reply = ask(Order::Request(request));
            let state = controller::Refusal::State(State::Fault);
            assert_eq!(reply, Reply::Refused(Refusal::Request(state)));
        }
    }
    assert_eq!(ask(Order::Request(Request::ClearFault)), Reply::Done);
    let unknown = Reply::Refused(Refusal::Request(controller::Refusal::NotHomed));
    assert_eq!(ask(Order::Request(Request::Arm)), unknown);
}
