//! An arm that a program commands call by call, with its controller on each emulated board.

use fivebar_files::robot::Robot;
use fivebar_files::scenario::Scenario;
use fivebar_firmware::safety::State;
use fivebar_sim::controller::ControllerSource;
use fivebar_sim::drive::Homing;
use fivebar_sim::link::Emulator;
use fivebar_sim::live::{LiveArm, Pace};
use fivebar_sim::machine::Machine;

/// Homes, draws a stroke of 2 mm and stops the arm at once.
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
