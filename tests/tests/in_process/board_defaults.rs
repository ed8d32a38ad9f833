//! The firmware's built-in settings are those of the benchtop arm's robot file, and the wiring's
//! page and drawing have the board's pins.

use fivebar_files::robot::Robot;
use fivebar_firmware::Settings;
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

#[test]
fn the_wiring_names_every_pin_that_the_board_uses() {
    let code = concat!(
        include_str!("../../../firmware/src/board/stm32f405/pins.rs"),
        include_str!("../../../firmware/src/board/stm32f405/pwm.rs"),
    );
    let used: BTreeSet<_> = pins(code);
    assert!(used.len() >= 21, "{used:?}");
    let drawing = pins(include_str!("../../../docs/use/wiring.svg"));
    for places in [pins(section("Pins")), pins(section("Reset")), drawing] {
        let missing: Vec<_> = used.difference(&places).collect();
        assert!(missing.is_empty(), "{missing:?}");
    }
}
