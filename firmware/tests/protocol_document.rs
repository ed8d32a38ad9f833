//! `docs/protocol.md` says what the library does, byte for byte.

use fivebar_firmware::protocol::{
    Board, ControllerMessage, Decoder, HostMessage, Identity, Message, Mode, Order, Refusal, Reply,
    Reset, SectionKey, Sequence, encode,
};
use fivebar_firmware::{Move, MoveKind, Sensed};
use std::collections::BTreeMap;

const DOCUMENT: &str = include_str!("../../docs/protocol.md");

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

fn order(sequence: u16, order: Order) -> HostMessage {
    HostMessage {
        sequence: Sequence(sequence),
        order,
    }
}

fn reply(sequence: u16, reply: Reply) -> ControllerMessage {
    ControllerMessage::Reply {
        sequence: Sequence(sequence),
        reply,
    }
}

#[test]
fn every_example_is_what_the_library_writes_and_reads() {
    let orders = [
        (
            "hello",
            order(
                1,
                Order::Hello {
                    version: 1,
                    session: 7,
                },
            ),
        ),
        (
            "line",
            order(
                300,
                Order::Move(Move {
                    tag: 12,
                    kind: MoveKind::Line {
                        to: [0.0, 0.125],
                        feed: 0.5,
                    },
                }),
            ),
        ),
        (
            "get-section",
            order(301, Order::GetSection(SectionKey::Axis(1))),
        ),
        (
            "tick",
            order(
                302,
                Order::Tick(Sensed {
                    counts: [-1, 1000],
                    current: [2048, 2050],
                    bus_voltage: 3000,
                    home: [false, true],
                    ..Sensed::default()
                }),
            ),
        ),
    ];
    let replies = [
        (
            "hello-reply",
            reply(
                1,
                Reply::Hello(Identity {
                    version: 1,
                    board: Board::Stm32f405,
                    firmware: [0, 1, 0],
                    reset: Reset::Watchdog,
                }),
            ),
        ),
        ("version", reply(1, Reply::Refused(Refusal::Version(1)))),
        ("taken", reply(300, Reply::Taken { room: 15 })),
        (
            "refused",
            reply(300, Reply::Refused(Refusal::Mode(Mode::Fault))),
        ),
    ];

    let mut examples = examples();
    let mut bytes = |name| examples.remove(name).unwrap_or_default();
    for (name, message) in &orders {
        check(&bytes(name), message);
    }
    for (name, message) in &replies {
        check(&bytes(name), message);
    }
    assert!(examples.is_empty(), "examples unchecked: {examples:?}");
}
