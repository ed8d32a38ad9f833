//! The page does the same with every kind of drive.

use crate::arms::{ARMS, text};
use crate::in_process::{Page, Server};
use crate::state::{number, speed, time};
use fivebar_files::robot::Robot;
use serde_json::{Value, json};
use std::time::Duration;

pub(crate) fn robot(name: &str) -> Robot {
    Robot::parse(name, &text(name)).expect("a robot")
}

/// How far the tool of an arm goes to and fro [mm].
pub(crate) fn length_of(name: &str) -> f64 {
    match name {
        "leg" | "mit" | "classroom_servo" => 20.0,
        _ => 30.0,
    }
}

/// The speed below which the joints of an arm count as at rest [rad/s]. MIT-type drives tell it in steps of 0.1 rad/s, and the
/// arms that `fivebar new` proposes have little friction.
fn rest_speed(name: &str) -> f64 {
    match name {
        "mit" | "new" => 0.2,
        _ => 0.05,
    }
}

/// Whether the place of an arm is known after an emergency stop: open-loop steppers lose it.
fn keeps_its_place(name: &str) -> bool {
    !robot(name).has_steppers()
}

/// Strokes to and fro on the lines from 3 to 6, for some seconds.
pub(crate) fn load(page: &mut Page, length: f64) {
    let text = format!(
        "G21 G90 F2000\nM3\n{}",
        format!("G1 X{length}\nG1 X0\n").repeat(2)
    );
    page.accepted(&json!({ "load": { "name": "strokes", "text": text } }));
    let job = page.wait("the job", |message| message.get("job").cloned());
    assert!(job["refused"].is_null(), "{job}");
}

/// The job's notices and the tool's greatest way in x [m] until it has ended.
fn until_done(page: &mut Page, name: &str) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    loop {
        let message = page.next();
        if let Some(state) = message.get("state") {
            let x = number(&state["tool"][0]);
            (least, most) = (least.min(x), most.max(x));
        }
        let fault = message.get("fault");
        assert!(fault.is_none_or(Value::is_null), "{name}: {message}");
        if message["notice"]["text"] == "The job is done." {
            return most - least;
        }
    }
}

#[test]
fn a_job_is_loaded_run_stopped_and_resumed_whatever_turns_the_joints() {
    for name in ARMS {
        let (server, length) = (Server::of_robot(robot(name)), length_of(name));
        let mut page = server.page();
        page.take_control_and_arm();
        load(&mut page, length);
        page.accepted(&json!("run"));
        page.state("motion", |state| {
            state["state"] == "Running" && speed(state) > 0.05
        });
        page.request("stop");
        let rest = page.until_rest();
        page.pass(Duration::from_millis(200));
        let still = page.latest_state();
        let moved = [0, 1].map(|axis| number(&still["tool"][axis]) - number(&rest["tool"][axis]));
        assert!(moved[0].hypot(moved[1]) < 2e-4, "{name}: {moved:?} m");
        page.accepted(&json!("resume"));
        page.state("motion", |state| state["state"] == "Running");
        let way = until_done(&mut page, name);
        assert!((way - length / 1e3).abs() < 2e-3, "{name}: {way} m");
    }
}

#[test]
fn motion_lasts_as_long_as_its_button_is_held_whatever_turns_the_joints() {
    for name in ARMS {
        let server = Server::of_robot(robot(name));
        let mut page = server.page();
        page.take_control_and_arm();
        let begun = page.until_rest();
        let jog = page.accepted(&json!({ "jog": [0.0, 0.002] }));
        let moved = page.until_rest();
        let way = number(&moved["tool"][1]) - number(&begun["tool"][1]);
        assert!(
            (way - 2e-3).abs() < 1e-3,
            "{name}: {way} m after request {}",
            jog.number
        );
        let held = page.accepted(&json!({ "hold": [0.0, 0.01] }));
        page.renews = Some(held.number);
        page.pass(Duration::from_millis(500));
        page.renews = None;
        page.pass(Duration::from_millis(400));
        let after = page.until_rest();
        let way = number(&after["tool"][1]) - number(&moved["tool"][1]);
        assert!(
            (3e-3..9e-3).contains(&way),
            "{name}: {way} m in half a second at 10 mm/s"
        );
    }
}

/// What a drive knows of its place without power decides whether the arm must be homed again.
#[test]
fn an_emergency_stop_takes_the_power_of_all_and_the_place_of_open_loop_steppers() {
    for name in ARMS {
        let (server, is_known) = (Server::of_robot(robot(name)), keeps_its_place(name));
        let mut page = server.page();
        page.take_control_and_arm();
        load(&mut page, length_of(name));
        page.accepted(&json!("run"));
        page.state("motion", |state| speed(state) > 0.05);
        page.request("emergency_stop");
        page.stopped("emergency_stop");
        let fault = page.state_named("Fault");
        assert_eq!(fault["fault"], 10, "{name}");
        page.state("rest", |state| {
            speed(state) < rest_speed(name) && time(state) > time(&fault) + 0.5
        });
        page.request("clear_fault");
        page.pass(Duration::from_millis(1100));
        let state = page.latest_state();
        assert_eq!(state["homed"], is_known, "{name}");
        let armed = page.ask(&json!({ "request": "arm" })).refused;
        assert_eq!(armed.is_none(), is_known, "{name}: {armed:?}");
    }
}

/// The page replays a run from the states that it got while the job ran, as recording.js takes them.
#[test]
fn a_run_can_be_replayed_from_its_states_whatever_turns_the_joints() {
    for name in ARMS {
        let server = Server::of_robot(robot(name));
        let mut page = server.page();
        page.take_control_and_arm();
        let length = length_of(name);
        load(&mut page, length);
        page.accepted(&json!("run"));
        let (mut times, mut joints, mut drawn) = (Vec::new(), Vec::new(), Vec::new());
        loop {
            let message = page.next();
            if message["notice"]["text"] == "The job is done." {
                break;
            }
            let state = &message["state"];
            if state["left"].is_null() {
                continue;
            }
            times.push(time(state));
            assert!(state["tool"].is_array() && state["reference"].is_array());
            joints.push(number(&state["joints"][0][0]));
            let trail = state["trail"].as_array().expect("a trail");
            let down = trail.iter().filter(|sample| number(&sample[2]) > 0.0);
            drawn.extend(down.map(|sample| number(&sample[0])));
        }
        assert!(times.is_sorted_by(|a, b| a < b), "{name}: {times:?}");
        let way = |values: &[f64]| {
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least
        };
        // States come every 33 ms; the strokes take some seconds.
        assert!(way(&times) > 1.0 && times.len() > 30, "{name}: {times:?}");
        assert!(way(&joints) > 1e-3, "{name}: {joints:?}");
        let drawn = way(&drawn);
        assert!((drawn - length / 1e3).abs() < 2e-3, "{name}: {drawn} m");
    }
}
