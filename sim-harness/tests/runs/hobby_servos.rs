//! Jobs on an arm with hobby servos: how well it draws, what limits it, and what its controller does not see.

use crate::steppers::run;
use fivebar_design::Noise;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;
use fivebar_kinematics::five_bar::Joint;
use fivebar_plant::{FaultKind, HobbyServo, PlantFault};
use fivebar_sim::simulation::{
    DemoScaleError, Record, RunError, Simulate, Summary, find_demo_scale,
};
use std::sync::LazyLock;

/// The built-in plotter with these changes of its text, each in all places.
fn plotter(changes: &[(&str, &str)]) -> Robot {
    let mut text = BuiltIn::find("classroom_servo")
        .expect("built in")
        .text
        .to_owned();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    Robot::parse("arm.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// The demonstration on the built-in plotter.
static DEMONSTRATION: LazyLock<(Scenario, Summary, Record)> = LazyLock::new(|| {
    let scenario = Scenario::demonstration(plotter(&[]));
    let (summary, record) = run(&scenario);
    (scenario, summary, record)
});

fn petal(robot: Robot) -> Scenario {
    let text = include_str!("../../../host/files/jobs/petal.gcode");
    let mut scenario = Scenario::new("petal", robot, "petal.gcode", text.into());
    scenario.fit().unwrap();
    scenario
}

/// The greatest distance between a joint's set-point and its angle [rad].
fn greatest_error(record: &Record) -> f64 {
    let samples = record.trace.samples();
    let errors = samples
        .iter()
        .flat_map(|sample| Joint::ALL.map(|j| (sample.reference_angle[j] - sample.angle[j]).abs()));
    errors.fold(0.0, f64::max)
}

/// What is expected of it: the dead band, the way of the joint in the time in which its servo is late, and half a unit of
/// the timer, for a joint without a load.
fn expected_error(servo: &HobbyServo, record: &Record) -> f64 {
    let samples = record.trace.samples();
    let speeds = samples.windows(2).flat_map(|pair| {
        let time = pair[1].time - pair[0].time;
        let turned = |j: Joint| pair[1].reference_angle[j] - pair[0].reference_angle[j];
        Joint::ALL.map(|j| (turned(j) / time).abs())
    });
    let fastest = speeds.fold(0.0, f64::max);
    let late = servo.longest_delay() + servo.lag();
    servo.dead_angle() + fastest * late + servo.angle_per_width() * HobbyServo::UNIT
}

#[test]
fn the_demonstration_is_drawn_within_the_dead_band_and_the_way_of_the_delay() {
    let (scenario, summary, record) = &*DEMONSTRATION;
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    assert_eq!(summary.lost_steps, None);
    let limits = summary.hobby_servos.as_ref().unwrap();
    // 5 µs of 2 ms for π; a frame, the longest pulse, and the loop's 0.15 rad over 10.5 rad/s.
    assert!((limits.dead_band_m - 0.2 * 0.0025 * std::f64::consts::PI).abs() < 1e-9);
    assert!((limits.late_s - (0.02 + 0.0025 + 0.15 / 10.5)).abs() < 1e-12);
    let [servo, _] = scenario.robot.hobby_servos().unwrap();
    let (found, expected) = (greatest_error(record), expected_error(&servo, record));
    assert!(found < expected, "{found} rad, {expected} expected");
    // It is as bad as is said: no less than the dead band.
    assert!(found > servo.dead_angle(), "{found} rad");
    // A servo turns to its first set-point from wherever the hand has put the arm, 0.1 rad away here.
    let first = record.trace.samples().first().unwrap();
    for j in Joint::ALL {
        let off = first.angle[j] - scenario.robot.home[j];
        assert!(off.abs() < 1.5 * servo.dead_angle() + 0.1, "{off}");
    }
}

/// Dead band [µs], frame rate [Hz] and speed [mm/s] of the document's rows. The first are the built-in plotter's.
const ROWS: [(f64, f64, f64); 5] = [
    (5.0, 50.0, 30.0),
    (5.0, 50.0, 60.0),
    (2.0, 50.0, 30.0),
    (2.0, 333.0, 30.0),
    (2.0, 333.0, 60.0),
];

/// A row of the document.
fn row(
    (dead_band, frame_rate, speed): (f64, f64, f64),
    (summary, record): (&Summary, &Record),
) -> String {
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    let error = &summary.tip_error;
    format!(
        "| {dead_band} | {frame_rate} | {speed} | {:.1} | {:.1} |\n",
        1e3 * error.rms_m,
        1e3 * error.max_m
    )
}

/// The rows of the document, as this program finds them.
fn table() -> String {
    let mut text = String::new();
    for (dead_band, frame_rate, speed) in ROWS {
        let robot = plotter(&[
            ("dead_band = 5e-6", &format!("dead_band = {dead_band:?}e-6")),
            (
                "frame_rate = 50.0\n",
                &format!("frame_rate = {frame_rate:?}\n"),
            ),
            (
                "max_speed = 0.03",
                &format!("max_speed = {:?}", 1e-3 * speed),
            ),
        ]);
        let (summary, record) = run(&Scenario::demonstration(robot));
        text += &row((dead_band, frame_rate, speed), (&summary, &record));
    }
    text
}

const DOCUMENT: &str = include_str!("../../../docs/verify/hobby-servos.md");

#[test]
#[ignore = "a quarter of a minute: ./ci.sh tables"]
fn whole_table_of_the_accuracy_that_dead_bands_and_frame_rates_give() {
    let table = table();
    assert!(DOCUMENT.contains(&table), "{table}");
}

#[test]
fn the_document_states_the_accuracy_that_is_found() {
    let document = DOCUMENT;
    let (_, summary, record) = &*DEMONSTRATION;
    let first = row(ROWS[0], (summary, record));
    assert!(document.contains(&first), "{first}");
    let robot = plotter(&[]);
    let [servo, _] = robot.hobby_servos().unwrap();
    let reach = 0.08 + 0.12;
    for (figure, unit) in [
        (1e3 * servo.dead_angle(), "mrad"),
        (1e3 * servo.dead_angle() * reach, "mm"),
        (1e3 * servo.longest_delay(), "ms"),
        (1e3 * servo.lag(), "ms"),
    ] {
        let stated = format!("{figure:.1} {unit}");
        assert!(document.contains(&stated), "{stated}");
    }
}

/// Arms of random sizes with random servos, with masses and friction off by 15 %: each draws within what is expected.
#[test]
fn random_arms_with_random_servos_draw_within_what_is_expected() {
    draw_within_what_is_expected(0..3);
}

#[test]
#[ignore = "some seconds: ./ci.sh tables"]
fn whole_table_of_random_arms_with_random_servos_that_draw_as_expected() {
    draw_within_what_is_expected(0..8);
}

fn draw_within_what_is_expected(seeds: std::ops::Range<u64>) {
    for seed in seeds {
        let mut noise = Noise::new(seed);
        let mut between = |least: f64, greatest: f64| least + (greatest - least) * noise.uniform();
        let size = between(0.8, 1.3);
        let torque = between(0.15, 1.5);
        let speed = between(6.0, 12.0);
        let dead_band = between(1.0, 8.0);
        let frame_rate = between(50.0, 333.0);
        let travel = between(3.05, 4.7);
        let reversed = if seed % 2 == 0 { "1.0" } else { "-1.0" };
        let robot = plotter(&[
            ("length = 0.08", &format!("length = {:?}", 0.08 * size)),
            ("length = 0.12", &format!("length = {:?}", 0.12 * size)),
            (
                "stall_torque = 0.177",
                &format!("stall_torque = {torque:?}\ngear_ratio = {reversed}"),
            ),
            ("max_speed = 10.5", &format!("max_speed = {speed:?}")),
            ("dead_band = 5e-6", &format!("dead_band = {dead_band:?}e-6")),
            (
                "frame_rate = 50.0\n",
                &format!("frame_rate = {frame_rate:?}\n"),
            ),
            ("travel = 3.1415927", &format!("travel = {travel:?}")),
        ]);
        let [servo, _] = robot.hobby_servos().unwrap();
        let mut scenario = petal(robot);
        let off = if seed % 3 == 0 { 0.15 } else { -0.15 };
        (scenario.mismatch.link_mass, scenario.mismatch.friction) = (off, off);
        let (summary, record) = run(&scenario);
        assert!(record.faults.is_empty(), "{seed}: {:?}", record.faults);
        assert!(summary.verdict.drawn, "{seed}: {:?}", summary.verdict);
        let (found, expected) = (greatest_error(&record), expected_error(&servo, &record));
        assert!(
            found < 1.1 * expected,
            "{seed}: {found} rad, {expected} expected"
        );
    }
}

#[test]
fn a_servo_that_is_held_is_not_seen_and_spoils_the_drawing() {
    let mut scenario = petal(plotter(&[]));
    let kind = FaultKind::MotorStalled {
        joint: Joint::Joint4,
    };
    scenario.faults.push(PlantFault { at: 1.0, kind });
    let (summary, record) = run(&scenario);
    assert!(record.faults.is_empty(), "{:?}", record.faults);
    assert!(summary.tip_error.max_m > 5e-3, "{:?}", summary.tip_error);
    assert!(!summary.verdict.drawn, "{:?}", summary.verdict);
}

#[test]
fn an_arm_that_would_draw_the_demonstration_wrong_has_no_scale_for_it() {
    // Torque for little more than the friction.
    let weak = plotter(&[("stall_torque = 0.177", "stall_torque = 0.007")]);
    let refused = find_demo_scale(&weak).unwrap_err();
    assert!(matches!(refused, DemoScaleError::NotDrawn(_)), "{refused}");
    assert!(
        refused.to_string().contains("the tolerance is 2.7"),
        "{refused}"
    );
}

#[test]
fn an_emergency_stop_ends_the_drawing_in_its_tick() {
    let mut scenario = petal(plotter(&[]));
    let kind = FaultKind::EmergencyStop;
    scenario.faults.push(PlantFault { at: 0.5, kind });
    let (summary, record) = run(&scenario);
    assert_eq!(summary.faults, ["emergency stop"]);
    assert!(record.job_time.unwrap() < 0.502);
}

#[test]
fn what_is_of_brushed_motors_refuses_hobby_servos() {
    let mut scenario = petal(plotter(&[]));
    let refused = |error: RunError| error.to_string().contains("has hobby servos");
    assert!(scenario.plant().is_err_and(refused));
    assert!(scenario.controller().is_err_and(refused));
    assert!(scenario.under_pid().is_none());
    scenario.time_optimal = Some(0.7);
    let job = scenario.job().unwrap();
    let error = scenario.simulate(&job, &mut |_| ()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("leave out the time-optimal plan"),
        "{error}"
    );
}
