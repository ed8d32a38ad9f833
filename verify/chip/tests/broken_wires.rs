//! Each wire of the table `docs/verify/data/broken_wires.csv`, off while the arm moves: the fault that
//! the table states, and nothing that moves until it is cleared.

mod bench;

use bench::Driven;
use bench::raised::{moving, stays_off_until_cleared, ticks_until_off};
use fivebar_chip::Pin;
use fivebar_chip::time::MILLISECOND;
use fivebar_firmware::Request;
use fivebar_firmware::safety::Fault;
use fivebar_kinematics::five_bar::Joint;

/// The fault that the table states for a broken wire.
fn stated(test: &str) -> Fault {
    let table = include_str!("../../../docs/verify/data/broken_wires.csv");
    let name = format!(",{test}");
    let row = table.lines().find(|line| line.ends_with(&name));
    let row = row.unwrap_or_else(|| panic!("broken_wires.csv has no row of {test}"));
    let (_, after) = row.split_once("fault ").expect("a fault");
    let digits = after.split(|letter: char| !letter.is_ascii_digit()).next();
    let number = digits.and_then(|digits| digits.parse::<u8>().ok());
    Fault::try_from(number.expect("a number")).expect("a known fault")
}

fn breaks(driven: &Driven, pin: Pin) {
    driven.arm.get().break_wire(pin);
    driven.chip().pins_changed();
}

/// The wire of a pin breaks while the arm moves: the fault of the document within so many ticks.
#[track_caller]
fn powers_off(test: &str, pin: Pin, within: u64) {
    let mut driven = moving();
    breaks(&driven, pin);
    let ticks = ticks_until_off(&mut driven, within);
    // The samples of a tick are taken up to a tick after the wire breaks.
    assert!(ticks <= within + 1, "{ticks} of {within}");
    if test == "an_emergency_stop_without_its_wire" {
        // It is raised again as soon as it is cleared.
        driven.run(2 * MILLISECOND);
        assert_eq!(driven.status().fault, Some(stated(test)));
    } else {
        stays_off_until_cleared(&mut driven, stated(test));
    }
}

#[test]
fn a_fault_output_without_its_wire() {
    for pin in [Pin(1, 0), Pin(1, 1)] {
        powers_off("a_fault_output_without_its_wire", pin, 1);
    }
}

#[test]
fn a_fault_output_without_its_wire_is_a_fault_at_every_wake_up() {
    let mut driven = moving();
    breaks(&driven, Pin(1, 1));
    driven.run(2 * MILLISECOND);
    for _ in 0..3 {
        driven.request(Request::ClearFault).expect("cleared");
        driven.request(Request::Arm).expect("armed");
        driven.run(3 * MILLISECOND);
        assert_eq!(driven.status().fault, Some(Fault::DriverFault));
        assert!(driven.is_off());
    }
}

#[test]
fn an_emergency_stop_without_its_wire() {
    powers_off("an_emergency_stop_without_its_wire", Pin(1, 12), 1);
}

#[test]
fn a_current_sensor_without_its_wire() {
    for pin in [Pin(2, 0), Pin(2, 1)] {
        powers_off("a_current_sensor_without_its_wire", pin, 1);
    }
    // With the bridges off it is found before they are switched on.
    let mut driven = Driven::new();
    breaks(&driven, Pin(2, 1));
    driven.run(500 * MILLISECOND);
    let angles = Joint::ALL.map(|joint| driven.arm.get().plant().angle(joint) as f32);
    driven.request(Request::SetAngles(angles)).expect("angles");
    let _ = driven.request(Request::Arm);
    driven.run(5 * MILLISECOND);
    assert!(driven.is_off());
}

#[test]
fn a_divider_without_its_supply() {
    powers_off("a_divider_without_its_supply", Pin(2, 2), 1);
}

#[test]
fn an_encoder_without_one_of_its_wires() {
    for pin in [Pin(0, 0), Pin(0, 1), Pin(0, 15), Pin(1, 3)] {
        powers_off("an_encoder_without_one_of_its_wires", pin, 400);
    }
}

#[test]
fn a_home_switch_without_its_wire() {
    for pin in [Pin(2, 4), Pin(2, 5)] {
        let mut driven = Driven::new();
        breaks(&driven, pin);
        driven.request(Request::Home).expect("homing");
        for _ in 0..200 {
            driven.run(20 * MILLISECOND);
            if driven.status().fault.is_some() {
                break;
            }
        }
        let fault = stated("a_home_switch_without_its_wire");
        assert_eq!(driven.status().fault, Some(fault));
    }
}
