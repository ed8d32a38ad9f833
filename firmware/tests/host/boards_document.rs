//! Compares the table of boards in `docs/use/wiring.md`, and `docs/use/board_pins.csv`, with the data.

use fivebar_firmware::drivers::boards::{BOARDS, Board, Pin, Row, Use};
use std::fmt::Write;

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/use/wiring.md");
const PINS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/use/board_pins.csv");
const BEGIN: &str = "<!-- boards, written by FIVEBAR_UPDATE=1 cargo test -p fivebar-firmware --test host boards -->\n";
const END: &str = "<!-- end -->";

/// The signals of a board, by the image that has them.
fn kinds(board: &Board) -> [(&'static str, Vec<Row>, Option<&'static str>); 4] {
    let common = board.common.rows(Use::Level).to_vec();
    [
        ("each image", common, None),
        (
            "brushed",
            board.brushed().rows().to_vec(),
            board.brushed.err(),
        ),
        (
            "steppers",
            board.stepper().rows().to_vec(),
            board.stepper.err(),
        ),
        ("CAN", board.can().rows().to_vec(), board.can.err()),
    ]
}

fn table() -> String {
    let mut text =
        String::from("| board | what it is | crystal | no image for |\n|---|---|---|---|\n");
    for board in &BOARDS {
        let refused = kinds(board).into_iter().filter_map(|(kind, _, why)| {
            let why = why?;
            Some(format!("{kind}: {why}"))
        });
        let refused: Vec<_> = refused.collect();
        let refused = if refused.is_empty() {
            "–".to_owned()
        } else {
            refused.join("; ")
        };
        let Board {
            name,
            what,
            crystal,
            ..
        } = board;
        writeln!(text, "| `{name}` | {what} | {crystal} MHz | {refused} |").expect("a text");
    }
    text
}

/// The pin of each signal on each board, as lines of values between commas.
fn pins() -> String {
    let names: Vec<_> = BOARDS.iter().map(|board| board.name).collect();
    let mut text = format!("image,signal,{}\n", names.join(","));
    let boards: Vec<_> = BOARDS.iter().map(kinds).collect();
    for (kind, (name, rows, _)) in boards[0].iter().enumerate() {
        for (at, row) in rows.iter().enumerate() {
            let pins = boards.iter().map(|board| match &board[kind] {
                (_, rows, None) => rows[at].pin.to_string(),
                _ => "–".to_owned(),
            });
            let pins: Vec<_> = pins.collect();
            writeln!(text, "{name},{},{}", row.signal, pins.join(",")).expect("a text");
        }
    }
    text
}

#[test]
fn the_wiring_has_the_pins_of_each_board() {
    let page = std::fs::read_to_string(DOCUMENT).expect("the page");
    let (before, rest) = page.split_once(BEGIN).expect("the table's begin");
    let (written, after) = rest.split_once(END).expect("the table's end");
    let table = table();
    if std::env::var_os("FIVEBAR_UPDATE").is_some() {
        std::fs::write(DOCUMENT, format!("{before}{BEGIN}{table}{END}{after}"))
            .expect("it is written");
        std::fs::write(PINS, pins()).expect("it is written");
        return;
    }
    assert_eq!(written, table);
    let written = std::fs::read_to_string(PINS).expect("the pins");
    assert_eq!(written, pins());
}

/// A Feather has no more pins than these at its edge, so that a row which names another one is wrong (its maker's pinout).
#[test]
fn the_feather_uses_pins_of_its_edge_alone() {
    let edge =
        "PA4 PA5 PA6 PA7 PC4 PC5 PB13 PB15 PB14 PB11 PB10 PB7 PB6 PC7 PC6 PB8 PB9 PC3 PC2 PC1";
    let board = Board::named("feather_f405").expect("the board");
    let mut pins: Vec<Pin> = Vec::new();
    for (_, rows, why) in kinds(&board) {
        pins.extend(rows.iter().filter(|_| why.is_none()).map(|row| row.pin));
    }
    assert_eq!(pins.len(), 9);
    for pin in pins {
        let name = pin.to_string();
        assert!(edge.split(' ').any(|at_edge| at_edge == name), "{name}");
    }
}
