//! Jobs on an arm with steppers.

use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, Mismatch, PlantFault};
use fivebar_sim::simulation::{Record, RunError, Simulate, Summary};

pub(crate) fn benchtop(change: impl Fn(&str) -> String) -> Robot {
    let text = BuiltIn::find("benchtop_stepper").expect("built in").text;
    Robot::parse("arm.toml", &change(text)).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn run(scenario: &Scenario) -> (Summary, Record) {
    let job = scenario.job().unwrap();
    scenario.simulate(&job, &mut |_| ()).unwrap()
}

fn demonstration() -> Scenario {
    Scenario::demonstration(benchtop(str::to_owned))
}

#[test]
fn the_demonstration_is_drawn_within_some_micro_steps_and_loses_none() {
    let (summary, record) = run(&demonstration());
    assert_eq!(summary.lost_steps, Some([0, 0]));
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    // A micro-step is 0.49 mrad at the joint, 0.12 mm at the most distant tool; twice that for the load angle.
    let error = summary.tip_error;
    assert!(error.rms_m < 0.12e-3 && error.max_m < 0.4e-3, "{error:?}");
    assert!(error.rms_m > 10e-6, "whole micro-steps are seen");
    assert_eq!(summary.saturated_ticks, 0);
}

#[test]
fn the_fastest_motion_within_the_share_of_the_torque_loses_no_step_and_far_above_it_it_does() {
    let mut scenario = demonstration();
    let (slow, _) = run(&scenario);
    scenario.time_optimal = Some(0.7);
    for mismatch in [-0.15, 0.0, 0.15] {
        scenario.mismatch = Mismatch {
            link_mass: mismatch,
            friction: mismatch,
            ..Mismatch::NONE
        };
        let (fast, record) = run(&scenario);
        assert_eq!(fast.lost_steps, Some([0, 0]), "{mismatch}");
        assert!(record.faults.is_empty());
        assert!(fast.job_s.unwrap() < 0.5 * slow.job_s.unwrap());
        // The load's angle alone would be 0.5 mm at the tool: the field leads by it.
        assert!(
            fast.tip_error.rms_m < 0.14e-3,
            "{mismatch}: {:?}",
            fast.tip_error
        );
    }
    let overloaded = benchtop(|text| text.replace("torque_share = 0.6", "torque_share = 1.3"));
    scenario.robot = overloaded;
    scenario.mismatch.payload = 0.02;
    let (lost, record) = run(&scenario);
    let steps = lost.lost_steps.unwrap();
    assert!(steps.iter().any(|&steps| steps != 0), "{steps:?}");
    assert!(steps.iter().all(|steps| steps % 4 == 0), "{steps:?}");
    // The demonstration passes the home switches, which show it.
    assert!(!record.faults.is_empty());
}

#[test]
fn a_driver_that_misses_steps_turns_the_drawing_by_them() {
    let mut scenario = demonstration();
    let kind = FaultKind::StepLost {
        joint: Joint::Joint4,
        steps: 2,
    };
    scenario.faults.push(PlantFault { at: 0.5, kind });
    let (summary, record) = run(&scenario);
    assert_eq!(summary.lost_steps.map(|steps| steps[1].abs()), Some(2));
    let last = record.trace.samples().last().unwrap();
    let off = last.reference_angle[1] - last.angle[1];
    let steps = 2.0 * std::f64::consts::TAU / 800.0;
    assert!((off.abs() - steps).abs() < 1e-3, "{off} rad for {steps}");
}

#[test]
fn an_emergency_stop_leaves_the_motors_without_current() {
    let mut scenario = demonstration();
    scenario.faults.push(PlantFault {
        at: 0.5,
        kind: FaultKind::EmergencyStop,
    });
    let (summary, record) = run(&scenario);
    assert_eq!(summary.faults, ["emergency stop"]);
    assert!(record.job_time.unwrap() < 0.502);
}

#[test]
fn what_is_of_brushed_motors_refuses_steppers() {
    let scenario = demonstration();
    let refused = |error: RunError| error.to_string().contains("has steppers");
    assert!(scenario.plant().is_err_and(refused));
    assert!(scenario.controller().is_err_and(refused));
}

#[test]
fn heavy_links_on_a_small_gear_ratio_are_not_drawn_at_the_limit_of_the_torque() {
    let mut scenario = demonstration();
    scenario.robot = benchtop(|text| {
        text.replace("gear_ratio = 4.0", "gear_ratio = 2.0")
            .replace("max_speed = [35.0, 35.0]", "max_speed = [30.0, 30.0]")
    });
    let (summary, _) = run(&scenario);
    assert_eq!(summary.lost_steps, Some([0, 0]));
    scenario.time_optimal = Some(0.7);
    let job = scenario.job().unwrap();
    let error = scenario.simulate(&job, &mut |_| ()).unwrap_err();
    assert!(
        error.to_string().contains("48 times the rotor's"),
        "{error}"
    );
}

/// The built-in arm with other lengths (inertias with their square) and another gear ratio, and the same speed at the
/// motors.
pub(crate) fn resized(size: f64, gear_ratio: f64) -> Robot {
    let number = |line: &str, key: &str| -> Option<f64> {
        let value = line.strip_prefix(key)?.trim_start_matches([' ', '=', '[']);
        value.split([',', ' ']).next()?.parse().ok()
    };
    benchtop(|text| {
        let line = |line: &str| {
            if let Some(length) = number(line, "length") {
                format!("length = {:?}", size * length)
            } else if let Some(base) = number(line, "base") {
                format!("base = {:?}", size * base)
            } else if let Some(along) = number(line, "com") {
                format!("com = [{:?}, 0.0]", size * along)
            } else if let Some(inertia) = number(line, "inertia") {
                format!("inertia = {:?}", size * size * inertia)
            } else if line.starts_with("gear_ratio") {
                format!("gear_ratio = {gear_ratio:?}")
            } else if line == "max_speed = [35.0, 35.0]" {
                format!("max_speed = [{0:?}, {0:?}]", 140.0 / gear_ratio)
            } else {
                line.to_owned()
            }
        };
        text.lines().map(|text| line(text) + "\n").collect()
    })
}

#[test]
fn arms_of_other_sizes_lose_no_step_with_masses_friction_and_supply_off() {
    let petal = include_str!("../../../host/files/jobs/petal.gcode");
    let cases = [
        (0.8, 3.0),
        (1.2, 4.0),
        (1.4, 6.0),
        (1.0, 6.0),
        (0.75, 2.0),
        (1.15, 3.0),
    ];
    for (index, (size, gear_ratio)) in cases.into_iter().enumerate() {
        let robot = resized(size, gear_ratio);
        assert!(robot.inertia_ratio().unwrap() < 30.0);
        let mut scenario = Scenario::new("petal", robot, "petal.gcode", petal.into());
        let off = |bit: usize| if index >> bit & 1 == 0 { 0.15 } else { -0.15 };
        scenario.mismatch = Mismatch {
            link_mass: off(0),
            friction: off(1),
            ..Mismatch::NONE
        };
        let volts = 24.0 * (1.0 + off(2));
        scenario
            .initial_faults
            .push(FaultKind::BusVoltage { volts });
        for time_optimal in [None, Some(0.7)] {
            scenario.time_optimal = time_optimal;
            let (summary, record) = run(&scenario);
            assert_eq!(summary.lost_steps, Some([0, 0]), "{size}, {gear_ratio}");
            assert!(record.faults.is_empty());
            assert!(summary.tip_error.rms_m < 1e-3, "{:?}", summary.tip_error);
        }
    }
}
