//! Compares `docs/design/protocol.md` with the library, byte by byte.

use crate::messages;
use fivebar_firmware::controller;
use fivebar_firmware::drives::BrushedSample;
use fivebar_firmware::motion::StreamPoint;
use fivebar_firmware::planner::{StreamPhase, StreamProgress, StreamReason};
use fivebar_firmware::protocol::{
    Board, CommandError, ControllerMessage, Decoder, HostCommand, HostMessage, Identity, Message,
    Reply, Reset, SectionKey, Sequence, StreamState, encode,
};
use fivebar_firmware::{FULL_TOOL, Move, MoveKind, Request, SensorSample};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use std::collections::{BTreeMap, BTreeSet};

const DOCUMENT: &str = include_str!("../../../docs/design/protocol.md");

/// The bytes of each block fenced as ```` ```example NAME ````: two hexadecimal digits
/// each, up to the first two spaces of a line.
fn examples() -> BTreeMap<&'static str, Vec<u8>> {
    DOCUMENT
        .split("```example ")
        .skip(1)
        .map(|block| {
            let (name, rest) = block.split_once('\n').expect("a name");
            let (body, _) = rest.split_once("```").expect("an end");
            let bytes = body
                .lines()
                .flat_map(|line| line.split("  ").next().unwrap_or("").split(' '))
                .map(|byte| u8::from_str_radix(byte, 16).expect("hexadecimal digits"))
                .collect();
            (name, bytes)
        })
        .collect()
}

fn check<M: Message + PartialEq + core::fmt::Debug>(bytes: &[u8], message: &M) {
    let written = encode(message).expect("it fits");
    assert_eq!(hex(bytes), hex(&written), "{message:?}");
    let mut decoder = Decoder::<M>::new();
    let read: Vec<_> = bytes
        .iter()
        .filter_map(|&byte| decoder.feed(byte))
        .collect();
    assert_eq!(read.len(), 1);
    assert_eq!(read[0].as_ref(), Ok(message));
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x} ")).collect()
}

fn command(sequence: u16, command: HostCommand) -> HostMessage {
    HostMessage {
        sequence: Sequence(sequence),
        command,
    }
}

fn reply(sequence: u16, reply: Reply) -> ControllerMessage {
    ControllerMessage::Reply {
        sequence: Sequence(sequence),
        reply,
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "a list of cases")]
fn every_example_is_what_the_library_writes_and_reads() {
    let commands = [
        (
            "hello",
            command(
                1,
                HostCommand::Hello {
                    version: 2,
                    session: 7,
                },
            ),
        ),
        ("arm", command(301, HostCommand::Request(Request::Arm))),
        (
            "line",
            command(
                300,
                HostCommand::Move(Move {
                    tag: 12,
                    tool: FULL_TOOL,
                    kind: MoveKind::Line {
                        to: [0.0, 0.125],
                        feed: 0.5,
                    },
                }),
            ),
        ),
        (
            "get-section",
            command(302, HostCommand::GetSection(SectionKey::Axis(1))),
        ),
        (
            "tick",
            command(
                303,
                HostCommand::Tick(SensorSample {
                    counts: [-1, 1000],
                    drives: BrushedSample {
                        current: [2048, 2050],
                        bus_voltage: 3000,
                    },
                    home: [false, true],
                    ..SensorSample::default()
                }),
            ),
        ),
        (
            "point",
            command(
                7,
                HostCommand::Point(StreamPoint {
                    id: 3,
                    due: 100_250,
                    position: (0.0, 0.125),
                    velocity: (0.5, 0.0),
                    force: (0.0, 0.0),
                }),
            ),
        ),
    ];
    let state = StreamState {
        tick: 100_000,
        progress: StreamProgress {
            id: 3,
            phase: StreamPhase::Follows,
            reason: Some(StreamReason::Late),
            last: Some(7),
            late: 1,
            lost: 0,
            refused: 0,
            limited: 0,
        },
        buffered: 250,
        angle: [2.0, 1.0],
        velocity: [0.5, -0.5],
        torque: [0.25, 0.0],
    };
    let replies = [
        ("stream", ControllerMessage::Stream(state)),
        (
            "hello-reply",
            reply(
                1,
                Reply::Hello(Identity {
                    version: 2,
                    board: Board::Stm32f405,
                    firmware: [0, 1, 0],
                    reset: Reset::Watchdog,
                }),
            ),
        ),
        (
            "version",
            reply(1, Reply::Refused(CommandError::Version(2))),
        ),
        ("taken", reply(300, Reply::Taken { free: 15 })),
        (
            "refused",
            reply(
                301,
                Reply::Refused(CommandError::Request(controller::RequestError::NotHomed)),
            ),
        ),
    ];

    let mut examples = examples();
    let mut bytes = |name| examples.remove(name).unwrap_or_default();
    for (name, message) in &commands {
        check(&bytes(name), message);
    }
    for (name, message) in &replies {
        check(&bytes(name), message);
    }
    assert!(examples.is_empty(), "examples unchecked: {examples:?}");
}

/// The number that an enum's value begins with on the wire, and its variant's name.
fn variant<T: serde::Serialize + core::fmt::Debug>(value: &T) -> (u8, String) {
    let mut bytes = [0; 256];
    let bytes = postcard::to_slice(value, &mut bytes).expect("it fits");
    let name = format!("{value:?}");
    let end = name.find(|c: char| !c.is_alphanumeric());
    (bytes[0], name[..end.unwrap_or(name.len())].to_owned())
}

#[test]
fn every_number_in_the_tables_is_the_one_on_the_wire() {
    // Enough random messages for every variant to occur.
    let mut runner = TestRunner::deterministic();
    let mut numbers = BTreeSet::new();
    for message in draw(&messages::host_message().boxed(), &mut runner) {
        numbers.insert(variant(&message.command));
        match message.command {
            HostCommand::Request(request) => numbers.insert(variant(&request)),
            HostCommand::Move(Move { kind, .. }) => numbers.insert(variant(&kind)),
            HostCommand::GetSection(key) => numbers.insert(variant(&key)),
            HostCommand::SetSection(section) => numbers.insert(variant(&section)),
            HostCommand::BoardTest(test) => numbers.insert(variant(&test)),
            _ => false,
        };
    }
    for message in draw(&messages::controller_message().boxed(), &mut runner) {
        let reply = match message {
            ControllerMessage::Reply { reply, .. } => reply,
            ControllerMessage::Telemetry(_) => continue,
            ControllerMessage::Stream(state) => {
                numbers.insert(variant(&state.progress.phase));
                numbers.extend(state.progress.reason.map(|reason| variant(&reason)));
                continue;
            }
        };
        numbers.insert(variant(&reply));
        match reply {
            Reply::Refused(error) => numbers.insert(variant(&error)),
            Reply::Board(report) => numbers.insert(variant(&report)),
            _ => false,
        };
    }

    let documented: BTreeSet<_> = DOCUMENT
        .lines()
        .filter_map(|line| {
            let mut cells = line.strip_prefix("| ")?.split(" | ");
            let number = cells.next()?.parse().ok()?;
            let name = cells.next()?.strip_prefix('`')?.strip_suffix('`')?;
            Some((number, name.to_owned()))
        })
        .collect();
    assert_eq!(documented, numbers);
}

fn draw<T: core::fmt::Debug>(
    strategy: &proptest::strategy::BoxedStrategy<T>,
    runner: &mut TestRunner,
) -> Vec<T> {
    (0..5000)
        .map(|_| strategy.new_tree(runner).expect("a value").current())
        .collect()
}
