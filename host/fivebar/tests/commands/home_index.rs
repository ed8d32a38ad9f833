//! `method = "index"` of `[homing]` from the robot file to the simulated arm, and what `fivebar
//! commission` says of its switches and index outputs.

use crate::commission::{commission, record, text, value};
use crate::home_methods::demonstrated;
use std::fs;
use std::path::Path;
use std::process::Output;

const BENCHTOP: &str = include_str!("../../../files/robots/benchtop.toml");

/// Commissions an arm with index pulses until after homing, with these lines in the scenario.
fn commissioned(folder: &Path, lines: &str) -> Output {
    let robot = folder.join("arm.toml");
    fs::write(
        &robot,
        // The switches 0.5 and 0.15 turns of the encoders behind home.
        BENCHTOP.to_owned() + "\n[homing]\nmethod = \"index\"\nswitch = [3.1852, 0.2312]\n",
    )
    .unwrap();
    fs::write(folder.join("dot.gcode"), "G1 X1 F600\n").unwrap();
    let scenario = folder.join("arm_as_it_is.toml");
    fs::write(
        &scenario,
        format!("robot = \"arm.toml\"\njob = \"dot.gcode\"\n{lines}\n"),
    )
    .unwrap();
    let (robot, scenario) = (robot.display().to_string(), scenario.display().to_string());
    let until = ["--until", "friction"];
    let files = ["--robot", &robot, "--scenario", &scenario];
    commission(folder, &[until.as_slice(), &files].concat())
}

#[test]
fn an_arm_with_index_pulses_is_homed_and_its_switches_are_judged() {
    for (lines, way4, warned) in [
        ("", 0.15, false),
        // The pulse of joint 4 lies nearer to its switch than the file says.
        ("[mismatch]\nhome_error = [0.0, -0.04]", 0.10, true),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = commissioned(folder.path(), lines);
        let said = text(&output.stdout);
        assert!(output.status.success(), "{said}{}", text(&output.stderr));
        let found = record(folder.path());
        for (joint, way) in [(1, 0.5), (4, way4)] {
            let seen = value(&found, &format!("index_way{joint}_turns"));
            assert!((seen - way).abs() < 0.02, "{seen} turns");
            let spread = value(&found, &format!("home_repeatability{joint}_rad"));
            // A count is 48 µrad.
            assert!(spread < 24e-6, "{spread} rad");
        }
        let warning =
            "the switch of joint 4 closes 0.10 turns of the encoder behind the index pulse";
        assert_eq!(said.contains(warning), warned, "{said}");
    }
}

#[test]
fn a_switch_near_a_pulse_and_an_index_output_without_a_wire_are_named() {
    for (lines, words) in [
        (
            "[mismatch]\nhome_error = [0.0, -0.09]",
            "joint 4 closes so near to an index pulse",
        ),
        (
            "[wiring]\nindex_dead = [true, false]",
            "the index output of joint 1 reads high all the time",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = commissioned(folder.path(), lines);
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
        let said = text(&output.stderr);
        assert!(said.contains(words), "{said}");
        assert!(said.contains("To do: "), "{said}");
    }
}

/// The switches close where they like, and the drawing does not move.
#[test]
fn a_drawing_does_not_depend_on_where_the_switches_close() {
    drawn_with_switches(&["switch = [3.3, 0.25]"]);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_switches_on_which_a_drawing_does_not_depend() {
    drawn_with_switches(&["", "switch = [2.95, 0.0]", "switch = [3.3, 0.25]"]);
}

fn drawn_with_switches(switches: &[&str]) {
    for keys in switches {
        let section = format!("\n[homing]\nmethod = \"index\"\n{keys}\n");
        let rms = demonstrated(&(BENCHTOP.to_owned() + &section));
        assert!(rms < 4e-6, "{rms} m with {keys}");
    }
}
