//! Every mishap of `docs/faults.md` that applies to it, on the emulated Cortex-M4F; each
//! of its answers has the bits of a controller in this process that is told the same.

mod bench;
mod mishaps;

use bench::{Bench, is_off};
use fivebar::run::link::Emulator;
use fivebar_firmware::Request;
use fivebar_firmware::controller;
use fivebar_firmware::protocol::{Order, Refusal, Reply, Reset, VERSION};
use fivebar_firmware::safety::State;

fn line() -> Emulator {
    Emulator::start(&Emulator::built_image("qemu")).expect("an emulated board")
}

mishaps::test_every_mishap!(line);

/// The reset button is pressed while the arm moves: the board comes up stopped, and knows
/// neither the host nor the arm.
#[test]
fn a_reset_in_motion() {
    let mut bench = Bench::moving(line());
    let board = bench.board.line().line();
    board.reset().expect("the emulator lives");
    let mut ask = |order| bench.board.call(order).expect("an answer");
    // Until it is reset it may answer once more.
    let stranger = Reply::Refused(Refusal::NoSession);
    let reset = (0..100).any(|_| ask(Order::Status) == stranger);
    assert!(reset, "it was never reset");
    let sensed = bench.plant.sense();
    assert_eq!(ask(Order::Tick(sensed)), stranger);
    let session = 99;
    let version = VERSION;
    let Reply::Hello(identity) = ask(Order::Hello { version, session }) else {
        panic!("no hello");
    };
    assert_eq!(identity.reset, Reset::Power);
    for _ in 0..20 {
        let Reply::Ticked(ticked) = ask(Order::Tick(bench.plant.sense())) else {
            panic!("no tick");
        };
        assert_eq!((ticked.state, ticked.fault), (State::Stopped, None));
        is_off(&ticked);
        bench.plant.step(&ticked.command, 1e-4);
        for request in [Request::Arm, Request::Home] {
            let reply = ask(Order::Request(request));
            assert_eq!(reply, Reply::Refused(Refusal::NoSettings));
        }
    }
    assert_eq!(ask(Order::ApplySettings), Reply::Done);
    let unknown = Reply::Refused(Refusal::Request(controller::Refusal::NotHomed));
    assert_eq!(ask(Order::Request(Request::Arm)), unknown);
}
