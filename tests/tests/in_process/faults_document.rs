//! Compares `docs/use/faults.md` and the tables of its tests, `fault_tests.csv` and `injected_faults.csv` in
//! `docs/verify/data`, with the controller; the tests that they name must exist.

use fivebar_firmware::safety::{Fault, Response};

const DOCUMENT: &str = include_str!("../../../docs/use/faults.md");
/// The tests of each fault in `firmware/tests`.
const FAULT_TESTS: &str = include_str!("../../../docs/verify/data/fault_tests.csv");
const INJECTED: &str = include_str!("../../../docs/verify/data/injected_faults.csv");
/// The files with the tests that they name.
const TESTS: [&str; 15] = [
    include_str!("../../../firmware/tests/controller/crossing.rs"),
    include_str!("../../../firmware/tests/controller/faults.rs"),
    include_str!("../../../firmware/tests/controller/holding_brake.rs"),
    include_str!("../../../firmware/tests/controller/homing.rs"),
    include_str!("../../../firmware/tests/controller/homing_index.rs"),
    include_str!("../../../firmware/tests/controller/lost_counts.rs"),
    include_str!("../../../firmware/tests/controller/step_drives.rs"),
    include_str!("../../../firmware/tests/controller/torque_drives.rs"),
    include_str!("../../../firmware/tests/host/session.rs"),
    include_str!("../../../firmware/tests/settings/storage.rs"),
    include_str!("faults_in_process.rs"),
    include_str!("../emulated_faults.rs"),
    include_str!("../emulated_boards.rs"),
    include_str!("../production_image.rs"),
    include_str!("../injected_faults/mod.rs"),
];

/// The cells of every row of the tables, their headings included.
fn rows(part: &str) -> Vec<Vec<&str>> {
    let cells = |line: &'static str| line.split('|').map(str::trim).collect::<Vec<_>>();
    let (_, from) = DOCUMENT.split_once(part).expect("the part");
    let lines = from.lines().take_while(|line| !line.starts_with("## "));
    lines
        .filter(|line| line.starts_with("| "))
        .map(|line| cells(line.trim_matches('|')))
        .collect()
}

/// The cells of every row of a table with commas between them, without its headings.
fn cells(table: &'static str) -> impl Iterator<Item = Vec<&'static str>> {
    table.lines().skip(1).map(|line| line.split(',').collect())
}

/// "encoder jump" of `EncoderJump`.
fn words(fault: Fault) -> String {
    fivebar_sim::simulation::fault_name(fault)
}

#[test]
fn every_fault_has_its_row_with_its_number_and_response() {
    let rows = rows("## The numbers");
    let faults: Vec<_> = rows
        .iter()
        .filter(|row| row[0].parse::<u8>().is_ok())
        .collect();
    let tests: Vec<_> = cells(FAULT_TESTS).collect();
    assert_eq!(faults.len(), Fault::all().count());
    assert_eq!(tests.len(), faults.len());
    for ((row, test), fault) in faults.into_iter().zip(tests).zip(Fault::all()) {
        assert_eq!(row[..2], test[..2]);
        assert_eq!(row[0], fault.number().to_string());
        assert_eq!(row[1], words(fault));
        let response = match fault.response() {
            Response::PowerOff => "off",
            Response::ControlledStop => "held",
        };
        assert_eq!(row[2].split(';').next(), Some(response), "{fault:?}");
    }
}

#[test]
fn every_injected_fault_names_its_fault_by_number_and_name() {
    let has_fault = |row: &Vec<&str>| !["none", "at the start"].contains(&row[1]);
    let named: Vec<_> = cells(INJECTED).filter(has_fault).collect();
    assert!(named.len() >= 14, "{named:?}");
    for row in named {
        let (number, name) = row[1].split_once(' ').expect("a number and a name");
        let number = number.parse::<u8>().expect("a number");
        let fault = Fault::try_from(number).expect("a known fault");
        assert_eq!(name, words(fault));
        let held = row[3].contains("held");
        assert_eq!(held, fault.response() == Response::ControlledStop, "{name}");
    }
}

#[test]
fn every_test_it_names_is_there() {
    let rows = cells(FAULT_TESTS).chain(cells(INJECTED));
    let names: Vec<_> = rows.filter_map(|row| row.last().copied()).collect();
    assert!(names.len() > 40, "{names:?}");
    for name in names {
        let function = format!("fn {name}(");
        let found = TESTS.iter().any(|file| file.contains(&function));
        assert!(found, "there is no test {name}");
    }
}
