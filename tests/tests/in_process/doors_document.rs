//! `docs/verify/data/doors.csv` says of each way to use an arm, a door, and of each kind of drive which test passes it, or why
//! there is none. These tests hold the table to the sources.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const TABLE: &str = include_str!("../../../docs/verify/data/doors.csv");

/// The columns behind the door, and how sources name their arm.
const KINDS: [(&str, &[&str]); 6] = [
    ("brushed", &["\"benchtop\""]),
    ("stepper", &["\"benchtop_stepper\""]),
    ("can_odrive", &["\"leg\""]),
    ("can_mit", &["\"mit\"", "MIT"]),
    ("hobby_servo", &["\"classroom_servo\""]),
    ("new", &["\"new\""]),
];
/// The source of the arms that tests of several doors share.
const ARMS: &str = "host/fivebar/tests/arms/mod.rs";

/// The cells of each row.
fn rows() -> Vec<Vec<&'static str>> {
    let cells = |line: &'static str| line.trim_matches('"').split("\",\"").collect();
    TABLE.lines().map(cells).collect()
}

/// The tests that a cell names, as source and function.
fn tests_of(cell: &str) -> impl Iterator<Item = (&str, &str)> {
    cell.split([' ', ';'])
        .filter_map(|word| word.split_once("::"))
}

fn source(path: &str) -> Option<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    fs::read_to_string(root.join(path)).ok()
}

/// The parts of a source that blank lines divide at its margin: functions and constants.
fn parts(text: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut is_after_blank = false;
    for line in text.lines() {
        if is_after_blank && line.starts_with(|it: char| !it.is_whitespace()) {
            parts.push(String::new());
        }
        is_after_blank = line.is_empty();
        let part = parts.last_mut().expect("a part");
        part.push_str(line);
        part.push('\n');
    }
    parts
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|it: char| !it.is_alphanumeric() && it != '_')
}

/// The names that a part defines at the margin.
fn defined(part: &str) -> BTreeSet<&str> {
    let lines = part.lines().filter(|line| !line.starts_with(' '));
    let name = |line| {
        let words: Vec<&str> = words(line).collect();
        let key = ["fn", "const", "static", "def"];
        let behind = words.iter().position(|word| key.contains(word));
        let assigned = line.split_once(" = ").map(|(name, _)| name);
        behind.map_or(assigned, |key| words.get(key + 1).copied())
    };
    lines.filter_map(name).collect()
}

/// The text of a function with that of all functions and constants of its source that it reaches by name, and with the list of
/// arms that sources share.
fn reached(text: &str, function: &str) -> Option<String> {
    let mut left = parts(text);
    if text.contains("use crate::arms::") {
        let shared = parts(&source(ARMS).expect("the arms"));
        left.extend(shared.into_iter().filter(|it| defined(it).contains("ARMS")));
    }
    let begin = left.iter().position(|part| {
        let [rust, python] = ["fn", "def"].map(|key| format!("{key} {function}("));
        part.contains(&rust) || part.contains(&python)
    })?;
    let mut reached = left.remove(begin);
    loop {
        let known: BTreeSet<&str> = words(&reached).collect();
        let is_reached = |part: &String| !defined(part).is_disjoint(&known);
        let Some(next) = left.iter().position(is_reached) else {
            return Some(reached);
        };
        let next = left.remove(next);
        reached.push_str(&next);
    }
}

/// What is wrong with a row, if anything.
fn trouble(row: &[&str]) -> Option<String> {
    let (door, cells) = row.split_first()?;
    if cells.len() != KINDS.len() {
        return Some(format!("{door}: {} cells", cells.len()));
    }
    cells
        .iter()
        .zip(KINDS)
        .find_map(|(cell, (kind, names))| {
            let is_not = cell.starts_with("not, because ");
            if !is_not && tests_of(cell).count() != 1 {
                return Some(format!("{kind}: no test and no reason: {cell:?}"));
            }
            tests_of(cell).find_map(|(path, function)| {
                let Some(text) = source(path) else {
                    return Some(format!("{kind}: there is no {path}"));
                };
                let Some(reached) = reached(&text, function) else {
                    return Some(format!("{kind}: {path} has no {function}"));
                };
                let is_shared = cells.iter().filter(|other| **other == *cell).count() > 1;
                let is_named = names.iter().any(|name| reached.contains(name));
                (is_shared && !is_not && !is_named)
                    .then(|| format!("{kind}: {function} does not name {names:?}"))
            })
        })
        .map(|trouble| format!("{door}, {trouble}"))
}

#[test]
fn each_door_has_a_test_for_each_kind_of_drive_or_the_reason_why_not() {
    let rows = rows();
    let (head, doors) = rows.split_first().expect("a head");
    let kinds = KINDS.map(|(kind, _)| kind);
    assert_eq!(head[1..], kinds);
    assert!(doors.len() >= 14, "{}", doors.len());
    let troubles: Vec<String> = doors.iter().filter_map(|row| trouble(row)).collect();
    assert!(troubles.is_empty(), "{troubles:#?}");
}

#[test]
fn a_wrong_row_of_the_table_is_found() {
    let rows = rows();
    let row = rows.iter().find(|row| row[0] == "sim").expect("a door");
    assert_eq!(trouble(row), None);
    let changed = |kind: usize, cell: &'static str| {
        let mut row = row.clone();
        row[kind] = cell;
        trouble(&row).unwrap_or_default()
    };
    for (cell, words) in [
        ("", "stepper: no test and no reason"),
        ("later", "stepper: no test and no reason"),
        ("tests/nowhere.rs::some", "there is no tests/nowhere.rs"),
        ("ci.sh::some", "ci.sh has no some"),
        (
            "not, because it is tried by ci.sh::some",
            "ci.sh has no some",
        ),
    ] {
        let found = changed(2, cell);
        assert!(found.contains(words), "{cell}: {found}");
    }
    // A test for several kinds that does not name one of them.
    let alone = "python/tests/test_connection.py::test_pauses_wait_for_their_user";
    let found = trouble(&["door", alone, alone, alone, alone, alone, alone]);
    assert!(found.is_some_and(|found| found.contains("does not name")));
}
