//! Every fault injected by `docs/verify/data/injected_faults.csv` that applies to it, on the emulated Cortex-M4F; each
//! reply has the bits of a controller in this process that gets the same commands.

mod bench;
mod injected_faults;

use bench::{Bench, is_off};
use fivebar_firmware::Request;
use fivebar_firmware::controller;
use fivebar_firmware::protocol::{CommandError, HostCommand, Reply, Reset, VERSION};
use fivebar_firmware::safety::State;
use fivebar_sim::link::Emulator;

fn line() -> Emulator {
    Emulator::start(&Emulator::built_image("qemu")).expect("an emulated board")
}

injected_faults::test_every_injected_fault!(line);

/// The reset button is pressed while the arm moves: the board starts stopped, without a session
/// and without settings.
#[test]
fn a_reset_in_motion() {
    let mut bench = Bench::moving(line());
    let board = bench.board.line().line();
    board.reset().expect("the emulator lives");
    let mut ask = |command| bench.board.call(command).expect("an answer");
    // It may reply once more before the reset.
    let stranger = Reply::Refused(CommandError::NoSession);
    let reset = (0..100).any(|_| ask(HostCommand::Status) == stranger);
    assert!(reset, "it was never reset");
    let sample = bench.plant.sense();
    assert_eq!(ask(HostCommand::Tick(sample)), stranger);
    let session = 99;
    let version = VERSION;
    let Reply::Hello(identity) = ask(HostCommand::Hello { version, session }) else {
        panic!("no hello");
    };
    assert_eq!(identity.reset, Reset::Power);
    for _ in 0..20 {
        let Reply::StepResult(result) = ask(HostCommand::Tick(bench.plant.sense())) else {
            panic!("no tick");
        };
        assert_eq!((result.state, result.fault), (State::Stopped, None));
        is_off(&result);
        bench.plant.step(&result.command, 1e-4);
        for request in [Request::Arm, Request::Home] {
            let reply = ask(HostCommand::Request(request));
            assert_eq!(reply, Reply::Refused(CommandError::NoSettings));
        }
    }
    assert_eq!(ask(HostCommand::ApplySettings), Reply::Done);
    let unknown = Reply::Refused(CommandError::Request(controller::RequestError::NotHomed));
    assert_eq!(ask(HostCommand::Request(Request::Arm)), unknown);
}
