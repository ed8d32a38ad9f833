//! An arm that a program commands call by call, with its controller on each emulated board.

use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::motion::{StreamMode, StreamPolicy};
use fivebar_firmware::safety::State;
use fivebar_sim::controller::ControllerSource;
use fivebar_sim::drive::Homing;
use fivebar_sim::link::Emulator;
use fivebar_sim::live::{LiveArm, Pace};
use fivebar_sim::machine::Machine;
use fivebar_sim::streaming::{SetPoint, StreamOptions};
use std::f64::consts::TAU;

/// Streams a circle of 2 mm at 500 points a second, from rest to rest in 0.6 s.
fn streams(name: &str, arm: &LiveArm) {
    arm.motors_on().expect("an order").finish().expect("power");
    let place = || {
        arm.progress()
            .status
            .tool
            .expect("a homed arm")
            .map(f64::from)
    };
    let [x, y] = place();
    let stream = arm.stream(StreamOptions {
        mode: StreamMode::Tip,
        rate: 500.0,
        delay: None,
        policy: StreamPolicy::Stop,
        fixtures: [None; 3],
    });
    let stream = stream.expect("an order");
    let mut farthest = 0.0_f64;
    for point in 0..=300 {
        let u = f64::from(point) / 300.0;
        let (sine, cosine) = (TAU * u * u * (3.0 - 2.0 * u)).sin_cos();
        assert!(
            stream.send(SetPoint::at([x + 2e-3 * sine, y + 2e-3 * (1.0 - cosine)])),
            "{name}"
        );
        let [now_x, now_y] = place();
        farthest = farthest.max((now_x - x).hypot(now_y - y));
    }
    stream
        .finish()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    let told = arm.progress().stream.expect("a state").progress;
    assert_eq!([told.late, told.lost, told.refused], [0; 3], "{name}");
    let [now_x, now_y] = place();
    let off = (now_x - x).hypot(now_y - y);
    // Hobby servos lag by a period of their pulses.
    assert!(
        off < 1e-3 && (farthest - 4e-3).abs() < 7e-4,
        "{name}: {off} m, {farthest} m"
    );
}

/// Homes, draws a stroke of 2 mm, follows a stream and stops the arm at once.
fn draws_and_stops(name: &str) {
    let robot = Robot::load(name).expect("a built-in robot");
    let image = Emulator::built_image(Machine::of(robot.drive_kind()).emulated);
    let source = ControllerSource::Emulated(&image);
    let arm = LiveArm::open(&robot, source, Pace::AsFastAsPossible).expect("a board");
    let home = arm.home(Homing::IfUnknown).expect("an order");
    home.finish()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    let place = || arm.progress().status.tool.expect("a homed arm");
    let [x, y] = place();
    let job = "G21 G90\nM3\nG1 X2 Y0 F600\nM5\n".into();
    let scenario = Scenario {
        origin: Some([x, y].map(f64::from)),
        ..Scenario::new("stroke", robot, "stroke", job)
    };
    let job = scenario.job().expect("a job");
    let drawn = arm.draw(&scenario, &job).expect("a stroke within reach");
    drawn
        .finish()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    let [now_x, now_y] = place();
    let off = (now_x - x - 2e-3).hypot(now_y - y);
    assert!(off < 1e-3, "{name}: {off} m");
    streams(name, &arm);
    arm.emergency_stop().expect("a stop");
    assert_eq!(arm.progress().status.state, State::Fault, "{name}");
}

#[test]
fn brushed_motors_are_commanded_on_the_emulated_board() {
    draws_and_stops("benchtop");
}

#[test]
fn steppers_are_commanded_on_the_emulated_board() {
    draws_and_stops("benchtop_stepper");
}

#[test]
fn drives_on_a_bus_are_commanded_on_the_emulated_board() {
    draws_and_stops("leg");
}

#[test]
fn hobby_servos_are_commanded_on_the_emulated_board() {
    draws_and_stops("classroom_servo");
}
