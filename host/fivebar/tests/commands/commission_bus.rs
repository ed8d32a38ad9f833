//! `fivebar commission` on simulated arms with drives on a CAN bus: each wrong wiring is named by its step, a sound arm gets to
//! the end, and an arm as workshops build it draws within 25 µm afterwards.

use crate::arms::MIT;
use crate::commission::{commission, record, text, value};
use crate::commission_kinds::{Mistake, changed, commissioned, each_is_named, scenario};
use fivebar_files::robot::{CanMotor, Draft, Motors};
use fivebar_testkit::program;
use std::fs;

const PETAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../files/jobs/petal.gcode");

/// Those of drives on a bus.
pub(crate) const OF_BUS: &[Mistake] = &[
    (
        "switches_swapped = true",
        "switches",
        "the home switches are swapped",
    ),
    (
        "switch_inverted = [true, false]",
        "switches",
        "the home switch of joint 1 is stuck",
    ),
    (
        "switch_dead = [false, true]",
        "switches",
        "the home switch of joint 4 is stuck",
    ),
    (
        "motor_reversed = [true, false]",
        "encoders",
        "the drive of joint 1 is reversed",
    ),
    (
        "nodes_swapped = true",
        "encoders",
        "the drives are swapped: joint 1 was turned and the drive of joint 4 tells it",
    ),
    (
        "node_of_other = [false, true]",
        "encoders",
        "both drives have number 1: none answers as 2",
    ),
    // The other drive's answer comes later, and hides this one's.
    (
        "node_of_other = [true, false]",
        "encoders",
        "the drive of joint 1 does not answer as number 1",
    ),
    (
        "bus_dead = [false, true]",
        "encoders",
        "the drive of joint 4 does not answer as number 2",
    ),
    (
        "supply_dead = [true, false]",
        "encoders",
        "the drive of joint 1 does not answer as number 1",
    ),
    (
        "motor_dead = [false, true]",
        "motors",
        "the motor of joint 4 gives no torque",
    ),
    (
        "orders_lost = [0.02, 0.0]",
        "motors",
        "a drive does not answer in time while it has power",
    ),
    (
        "orders_lost = [0.0, 0.5]",
        "motors",
        "60 Ω between CANH and CANL",
    ),
    (
        "answers_lost = [0.0, 0.02]",
        "motors",
        "a drive does not answer in time while it has power",
    ),
    (
        "torque_constant = [0.4, 0.0]",
        "torque",
        "the torque constant of joint 1 is wrong: its drive gives 1.",
    ),
    (
        "torque_constant = [0.0, -0.4]",
        "torque",
        "the torque constant of joint 4 is wrong: its drive gives 0.",
    ),
];

/// The mistakes that only some drives on a bus can have: of another mode, which the controller itself sets of an ODrive, and of a
/// zero that they know.
pub(crate) const OF_MIT: &[Mistake] = &[(
    "mode_wrong = [true, false]",
    "encoders",
    "the drive of joint 1 does not answer as number 1",
)];
pub(crate) const OF_ABSOLUTE: &[Mistake] = &[
    (
        "zero_shift = [0.05, 0.0]",
        "zero",
        "the drive of joint 1 has lost its zero",
    ),
    (
        "zero_shift = [0.0, -0.05]",
        "zero",
        "the drive of joint 4 has lost its zero",
    ),
];

/// What makes drives of them that know the angles of their joints.
const ABSOLUTE: [(&str, &str); 2] = [
    ("gear_ratio = 3.0", "gear_ratio = 1.0"),
    (
        "[protection]",
        "[homing]\nmethod = \"absolute\"\n\n[protection]",
    ),
];

/// Each mistake of a leg that is changed like this.
fn each_of_a_leg_is_named(changes: &[(&str, &str)], mistakes: &[Mistake]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("leg.toml");
    fs::write(&file, changed("leg", changes)).unwrap();
    each_is_named(&file.display().to_string(), mistakes);
}

#[test]
fn each_wrong_wiring_of_odrives_is_found_by_its_step_and_named() {
    each_of_a_leg_is_named(&[], OF_BUS);
}

#[test]
fn each_wrong_wiring_of_mit_type_drives_is_found_by_its_step_and_named() {
    each_of_a_leg_is_named(&[MIT], OF_BUS);
    each_of_a_leg_is_named(&[MIT], OF_MIT);
}

#[test]
fn a_drive_that_has_lost_its_zero_is_named() {
    each_of_a_leg_is_named(&ABSOLUTE, OF_ABSOLUTE);
}

/// As it is built in; with other lengths, with its hips apart, and with other gears.
#[test]
fn arms_on_a_bus_get_to_the_end() {
    const WIDE: (&str, &str) = ("base = 0.0", "base = 0.04");
    const LONGER: (&str, &str) = ("length = 0.16", "length = 0.17");
    const GEARED: (&str, &str) = ("gear_ratio = 3.0", "gear_ratio = 4.0");
    for changes in [
        &[][..],
        &[WIDE],
        &[WIDE, LONGER, GEARED, MIT],
        &[&[WIDE], &ABSOLUTE[..]].concat(),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let robot = commissioned(folder.path(), &changed("leg", changes));
        assert_ne!(robot.geometry.lengths()[0], 0.09);
        let record = record(folder.path());
        assert_eq!(record["steps"].as_array().unwrap().len(), 10);
        for number in [1, 4] {
            let gives = value(&record, &format!("torque{number}_share"));
            assert!((gives - 1.0).abs() < 0.1, "{gives}");
            let turned = value(&record, &format!("turn_under_power{number}_share"));
            assert!((turned - 1.0).abs() < 0.05, "{turned}");
        }
        let after = value(&record, "tip_error_after_rms_m");
        assert!(after < 40e-6, "{after} m");
    }
}

/// Its file has no torque constant: nobody knows which current gives the torque, and nobody says so.
#[test]
fn an_arm_that_new_proposes_with_odrives_gets_to_the_end() {
    let mut draft = Draft::new("proposed");
    draft.motors = Motors::CanDrives(CanMotor::TYPICAL);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arm.toml");
    fs::write(&file, draft.text()).unwrap();
    let output = commission(folder.path(), &["--robot", &file.display().to_string()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert!(
        told.contains("torque_constant = that of your motor"),
        "{told}"
    );
    assert!(!told.contains("current_soft_max = 1"), "{told}");
    let record = record(folder.path());
    assert_eq!(record["steps"].as_array().unwrap().len(), 10);
    let after = value(&record, "tip_error_after_rms_m");
    assert!(after < 100e-6, "{after} m");
}

/// What a workshop's arm differs by from its file: masses, friction, lengths, encoders and switches, as in realistic.toml.
const WORKSHOP: &str = "[mismatch]
link_mass = 0.1
friction = 0.3
payload = 0.02
link_length = [5e-5, -5e-5, 5e-5, -5e-5]
base_length = 5e-5
home_error = [2e-4, -2e-4]
stiction = [0.3, 0.3]
encoder_error = [
    [{ harmonic = 1, amplitude = 2.5e-3, phase = 0.4 }, { harmonic = 2, amplitude = 1.0e-3, phase = 1.9 }],
    [{ harmonic = 1, amplitude = 2.5e-3, phase = 2.6 }, { harmonic = 2, amplitude = 1.0e-3, phase = 0.2 }],
]
";

#[test]
fn a_workshops_arm_on_a_bus_draws_within_25_micrometres_once_it_is_commissioned() {
    let folder = tempfile::tempdir().unwrap();
    let drawing = folder.path().join("wide.toml");
    fs::write(&drawing, changed("leg", &[("base = 0.0", "base = 0.04")])).unwrap();
    let drawing = drawing.display().to_string();
    let arm = scenario(folder.path(), &drawing, WORKSHOP);
    let output = commission(folder.path(), &["--robot", &drawing, "--scenario", &arm]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let placed = |robot: &str| {
        let drawn = scenario(
            folder.path(),
            robot,
            &format!("arm = \"{drawing}\"\n{WORKSHOP}"),
        );
        let job = fs::read_to_string(&drawn).unwrap();
        fs::write(&drawn, job.replace("dot.gcode", PETAL)).unwrap();
        let mut sim = program(env!("CARGO_BIN_EXE_fivebar"));
        sim.args(["sim", &drawn, "--json", "--out"]);
        let output = sim.arg(folder.path().join("sim")).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        summary["tip_error_placed"]["rms_m"].as_f64().unwrap()
    };
    let measured = folder.path().join("out/robot.toml").display().to_string();
    let (before, after) = (placed(&drawing), placed(&measured));
    assert!(
        after < 25e-6 && after < before,
        "{after} m after {before} m"
    );
}
