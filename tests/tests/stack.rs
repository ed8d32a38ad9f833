//! The stack that the images use, against the committed sizes and the space for it.

mod bench;

use bench::Bench;
use fivebar_firmware::protocol::{HostCommand, Reply, StackUse};
use fivebar_firmware::{Move, MoveKind, Request};
use fivebar_sim::link::{Client, Emulator};

/// As last committed [bytes].
#[derive(serde::Deserialize)]
struct Committed {
    /// Of the production image, as far as it gets on QEMU.
    stack: u32,
    /// Of the emulated board over a job.
    stack_emulated: u32,
}

const COMMITTED: &str = include_str!("../data/image_size.json");
/// The share by which another compiler's stack may differ from the committed one.
const TOLERANCE: f64 = 0.15;

fn committed() -> Committed {
    serde_json::from_str(COMMITTED).expect("the committed sizes")
}

/// The stack has the committed size, and a quarter of its space is free.
#[track_caller]
fn fits(StackUse { most, size }: StackUse, committed: u32) {
    println!("{most} of {size} bytes of stack");
    assert!(most > 1000, "the paint was found");
    assert!(4 * most <= 3 * size, "{most} of {size} bytes");
    let (most, committed) = (f64::from(most), f64::from(committed));
    assert!(
        (most - committed).abs() <= TOLERANCE * committed,
        "{most} bytes, committed {committed}; if that is right, write it into \
         tests/data/image_size.json"
    );
}

/// Settings put to use, every kind of move planned and followed, a stop, a fault.
#[test]
fn a_job_on_the_emulated_board_leaves_a_quarter_of_its_stack() {
    let line = Emulator::start(&Emulator::built_image("qemu")).expect("an emulated board");
    let mut bench = Bench::moving(line);
    let [_, [x, y]] = bench::ends();
    let kinds = [
        MoveKind::Arc {
            to: [x, y],
            center: [x - 0.01, y],
            clockwise: true,
            feed: 0.1,
        },
        MoveKind::Dwell { duration: 0.01 },
        MoveKind::Joint {
            to: [2.2, 0.9],
            speed: 0.5,
        },
    ];
    for (tag, kind) in (2..).zip(kinds) {
        let reply = bench.ask(HostCommand::Move(Move { tag, tool: 0, kind }));
        assert!(matches!(reply, Reply::Taken { .. }), "{reply:?}");
    }
    for _ in 0..300 {
        bench.tick();
    }
    bench.is_done(HostCommand::Request(Request::EmergencyStop));
    bench.tick();
    bench.ask(HostCommand::Snapshot);
    let used = bench.board.stack().expect("an answer");
    fits(used.expect("it knows"), committed().stack_emulated);
}

/// Without a crystal the production image takes no job, but it ticks by its interrupt, and
/// looks at settings, moves and its flash before it refuses them.
#[test]
fn the_production_image_leaves_a_quarter_of_its_stack() {
    let board = Emulator::start(&Emulator::built_image("stm32f405")).expect("an emulated board");
    let (mut client, _) = Client::open(board).expect("an answer");
    let settings = bench::robot().settings().expect("masses");
    let refused = client.write_settings(&settings).expect("answers");
    assert!(refused.is_err(), "its clock has failed");
    let kind = MoveKind::Dwell { duration: 0.01 };
    let a_move = HostCommand::Move(Move {
        tag: 1,
        tool: 0,
        kind,
    });
    for command in [
        a_move,
        HostCommand::SaveSettings,
        HostCommand::Telemetry { every: 1 },
    ] {
        client.call(command).expect("an answer");
    }
    let ticks = (0..1000).any(|_| {
        client.poll().expect("a line");
        client.take_telemetry().is_some()
    });
    assert!(ticks, "no telemetry");
    let used = client.stack().expect("an answer");
    fits(used.expect("it knows"), committed().stack);
}
