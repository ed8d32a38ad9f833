//! The firmware's built-in settings are those of the benchtop arm's robot file, and the wiring's
//! page and drawing have the board's pins.

use fivebar_files::robot::Robot;
use fivebar_firmware::Settings;
use fivebar_firmware::drivers::boards::{REFERENCE, Row, Use};
use std::collections::BTreeSet;

#[test]
fn the_firmware_starts_with_the_benchtop_robot_to_the_bit() {
    let robot = Robot::load("benchtop").expect("a built-in robot");
    let settings = robot.settings().expect("a robot with motors");
    assert_eq!(settings, Settings::BENCHTOP);
}

/// The names of pins in a text: P, the port, the number.
fn pins(text: &str) -> BTreeSet<&str> {
    text.split(|letter: char| !letter.is_ascii_alphanumeric())
        .filter(|word| {
            let port = word.strip_prefix('P').and_then(|rest| rest.get(1..));
            let number = port.filter(|_| word.as_bytes()[1].is_ascii_uppercase());
            number.is_some_and(|number| number.parse::<u8>().is_ok())
        })
        .collect()
}

/// The part of the wiring's page under this heading.
fn section(heading: &str) -> &'static str {
    let page = include_str!("../../../docs/use/wiring.md");
    let (_, after) = page
        .split_once(&format!("\n## {heading}\n"))
        .expect(heading);
    after.split_once("\n## ").map_or(after, |(here, _)| here)
}

/// The pins of an image on the first board are all named in each of these texts.
fn assert_named(own: &[Row], texts: &[&str]) {
    let common = REFERENCE.common.rows(Use::Level);
    let used: Vec<_> = common
        .iter()
        .chain(own)
        .map(|row| row.pin.to_string())
        .collect();
    for text in texts {
        let named = pins(text);
        let missing: Vec<_> = used
            .iter()
            .filter(|pin| !named.contains(pin.as_str()))
            .collect();
        assert!(missing.is_empty(), "{missing:?}");
    }
}

#[test]
fn the_wiring_names_every_pin_that_the_board_uses() {
    let drawing = include_str!("../../../docs/use/wiring.svg");
    let texts = [section("Pins"), section("Reset"), drawing];
    assert_named(&REFERENCE.brushed().rows(), &texts);
}

#[test]
fn the_wiring_of_steppers_names_every_pin_that_their_image_uses() {
    let drawing = include_str!("../../../docs/use/wiring-steppers.svg");
    assert_named(&REFERENCE.stepper().rows(), &[section("Steppers"), drawing]);
}

#[test]
fn the_wiring_of_drives_on_a_bus_names_every_pin_that_their_image_uses() {
    let drawing = include_str!("../../../docs/use/wiring-can.svg");
    assert_named(
        &REFERENCE.can().rows(),
        &[section("Drives on a CAN bus"), drawing],
    );
}

/// The names of a Pico 2's pins in a text: GP, the number.
fn pico_pins(text: &str) -> BTreeSet<&str> {
    text.split(|letter: char| !letter.is_ascii_alphanumeric())
        .filter(|word| {
            let number = word.strip_prefix("GP");
            number.is_some_and(|number| number.parse::<u8>().is_ok())
        })
        .collect()
}

/// The pins that a source of the RP2350's images states.
fn stated_pins(source: &str) -> BTreeSet<String> {
    source
        .lines()
        .filter_map(|line| line.strip_prefix("pub const ")?.split_once(" = "))
        .flat_map(|(_, value)| value.split(|letter: char| !letter.is_ascii_digit()))
        .filter(|number| !number.is_empty())
        .map(|number| format!("GP{number}"))
        .collect()
}

#[test]
fn the_wiring_of_a_pico_2_names_the_pins_that_its_images_use_and_no_others() {
    let common = stated_pins(include_str!("../../../firmware/src/board/rp2350/pins.rs"));
    let steppers = stated_pins(include_str!(
        "../../../firmware/src/board/rp2350/stepper/pins.rs"
    ));
    assert_eq!((common.len(), steppers.len()), (7, 8));
    assert!(common.is_disjoint(&steppers));
    let table = include_str!("../../../docs/use/pico_pins.csv");
    let rows: Vec<Vec<&str>> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect())
        .collect();
    let all: BTreeSet<_> = common.union(&steppers).cloned().collect();
    let named: BTreeSet<_> = rows.iter().map(|row| row[0].to_owned()).collect();
    assert_eq!(named, all);
    for (drawing, used) in [
        (include_str!("../../../docs/use/wiring-servos.svg"), &common),
        (
            include_str!("../../../docs/use/wiring-pico-steppers.svg"),
            &all,
        ),
    ] {
        let used: BTreeSet<_> = used.iter().map(String::as_str).collect();
        assert_eq!(pico_pins(drawing), used);
    }
}
