//! The page gets what the drives do, by their kind.

use crate::arms::text;
use crate::in_process::{Page, Server};
use crate::kinds::{length_of, load, robot};
use crate::state::{number, time};
use fivebar_files::robot::Robot;
use fivebar_kinematics::five_bar::Joint;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// The states with a running job, of an arm that was unpowered before.
fn run(name: &str, robot: Robot) -> (Value, Vec<Value>) {
    let server = Server::of_robot(robot);
    let mut page = server.page();
    let before = page.latest_state();
    page.take_control_and_arm();
    load(&mut page, length_of(name));
    page.accepted(&json!("run"));
    (before, states(&mut page))
}

fn states(page: &mut Page) -> Vec<Value> {
    let mut states = Vec::new();
    loop {
        let message = page.next();
        if message["notice"]["text"] == "The job is done." {
            return states;
        }
        if !message["state"]["left"].is_null() {
            states.push(message["state"].clone());
        }
    }
}

fn pair(state: &Value, index: usize) -> [f64; 2] {
    [0, 1].map(|joint| number(&state["drives"][index][joint]))
}

/// The greatest size of a value.
fn greatest(states: &[Value], index: usize) -> f64 {
    let sizes = states.iter().flat_map(|state| pair(state, index));
    sizes.fold(0.0, |most, value| most.max(value.abs()))
}

#[test]
fn brushed_motors_have_currents_and_duties() {
    let (before, states) = run("benchtop", robot("benchtop"));
    assert_eq!(before["drives"][1], json!([0.0, 0.0]));
    for state in &states {
        for joint in [0, 1] {
            assert_eq!(pair(state, 0)[joint], number(&state["current"][joint]));
            let duty = 100.0 * number(&state["duty"][joint]);
            assert!((pair(state, 1)[joint] - duty).abs() < 1e-4);
        }
    }
    let duty = greatest(&states, 1);
    assert!((0.5..100.0).contains(&duty), "{duty} %");
}

/// The micro-steps of a run are those of the angles through which the joints have turned. 0.4 N·m hold at 90°.
#[test]
fn steppers_have_micro_steps_and_load_angles() {
    for name in ["benchtop_stepper", "new"] {
        let robot = robot(name);
        let motors = robot.steppers().expect("steppers");
        let (before, states) = run(name, robot);
        assert_eq!(before["drives"], json!([null, null, null]), "{name}");
        for joint in Joint::ALL {
            let (motor, j) = (&motors[joint], joint.index());
            let per_turn =
                motor.gear_ratio * f64::from(motor.steps_per_turn) * f64::from(motor.microsteps);
            let (mut made, mut farthest, mut wrong) = (0.0, 0.0_f64, 0.0_f64);
            let first = &states[0];
            for [state, next] in states.array_windows() {
                let lasts = time(next) - time(state);
                made += 0.5 * lasts * (pair(state, 1)[j] + pair(next, 1)[j]);
                let turned = number(&next["angle"][j]) - number(&first["angle"][j]);
                let turned = turned * per_turn / TAU;
                farthest = farthest.max(turned.abs());
                wrong = wrong.max((made - turned).abs());
                let share = pair(next, 0)[j] / (motor.gear_ratio * motor.holding_torque);
                let sine = pair(next, 2)[j].to_radians().sin();
                assert!((sine - share).abs() < 1e-6, "{name}: {sine} for {share}");
            }
            assert!(farthest > 100.0, "{name}, {joint}: {farthest} micro-steps");
            assert!(
                wrong < 0.05 * farthest,
                "{name}, {joint}: {wrong} of {farthest}"
            );
        }
        let load = greatest(&states, 2);
        assert!((0.5..90.0).contains(&load), "{name}: {load}°");
    }
}

#[test]
fn steppers_with_encoders_tell_how_far_they_are_behind() {
    let text = text("benchtop_stepper").replace(
        "torque_share = 0.6",
        "torque_share = 0.6\nencoder_counts = 4000",
    );
    let robot = Robot::parse("encoders", &text).expect("a robot");
    let (_, states) = run("benchtop_stepper", robot);
    let behind = greatest(&states, 3);
    assert!((1e-3..1.0).contains(&behind), "{behind} full steps");
}

/// What a drive tells follows what is demanded of it, beside what its own spring adds.
#[test]
fn drives_on_a_bus_tell_their_torques() {
    for name in ["leg", "mit"] {
        let (_, states) = run(name, robot(name));
        for joint in [0, 1] {
            let mean = |of: &dyn Fn(&Value) -> f64| {
                states.iter().map(of).sum::<f64>() / states.len() as f64
            };
            let told = mean(&|state| pair(state, 0)[joint]);
            let demanded = mean(&|state| number(&state["torque"][joint]));
            let current = mean(&|state| pair(state, 1)[joint]);
            assert!(demanded.abs() > 0.02, "{name}: the leg bears its weight");
            assert!(
                (told - demanded).abs() < 0.07,
                "{name}: {told} for {demanded}"
            );
            assert!(
                (3.0 * 0.0243 * current / told - 1.0).abs() < 1e-3,
                "{name}: {current} A"
            );
        }
    }
}

#[test]
fn a_torque_is_not_shown_as_a_current_without_the_motors_torque_constant() {
    let text = text("leg").replace("torque_constant = 0.0243\n", "");
    let (_, states) = run("leg", Robot::parse("leg", &text).expect("a robot"));
    assert_eq!(states[0]["drives"].as_array().expect("values").len(), 1);
}

/// π is 2000 µs.
#[test]
fn hobby_servos_have_the_width_of_their_pulses() {
    let (before, states) = run("classroom_servo", robot("classroom_servo"));
    assert_eq!(before["drives"], json!([null, null]));
    let first = &states[0];
    let mut farthest = 0.0_f64;
    for state in &states {
        for (joint, middle) in [(0, 2.13), (1, 1.01)] {
            let width = pair(state, 1)[joint];
            let of = |state: &Value| number(&state["angle"][joint]) - middle;
            let expected = 1500.0 + of(state) * 2000.0 / std::f64::consts::PI;
            assert!((width - expected).abs() < 1.0, "{width} µs for {expected}");
            farthest = farthest.max((width - pair(first, 1)[joint]).abs());
        }
    }
    assert!(farthest > 30.0, "{farthest} µs");
}
