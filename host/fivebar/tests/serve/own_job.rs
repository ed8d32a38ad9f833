//! A job belongs to the host: it keeps its place, and runs on without a page if it was told to.

use crate::in_process::{Page, Server};
use crate::state::{number, speed, time};
use serde_json::{Value, json};

/// Loads four strokes to and fro of about four seconds, one on each line from 3 to 6, and waits for the last message that
/// comes of it. A job's message comes when the job is checked and
/// again when its time is planned; a page that reads late gets only the second.
pub(crate) fn load(page: &mut Page) {
    let text = format!("G21 G90 F3000\nM3\n{}", "G1 X40\nG1 X0\n".repeat(2));
    page.accepted(&json!({ "load": { "name": "strokes", "text": text } }));
    page.wait("the job", |message| message["job"]["time"].as_f64());
}

fn run(page: &mut Page) {
    page.send(&json!("run"));
    page.state("full speed", |state| {
        state["state"] == "Running" && speed(state) > 0.2 && state["tool_level"] == 1.0
    });
}

pub(crate) fn notice(page: &mut Page, words: &str) {
    page.wait(words, |message| {
        let text = message.get("notice")?.get("text")?.as_str()?;
        text.contains(words).then_some(())
    });
}

/// The positions of the tool where it was down until the job was done.
fn drawn_to_the_end(page: &mut Page) -> Vec<[f64; 2]> {
    drawn_with(page, |level| level == 1.0)
}

/// As [`drawn_to_the_end`], with a tool that is down at these levels.
fn drawn_with(page: &mut Page, is_down: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    let mut drawn = Vec::new();
    loop {
        let message = page.next();
        if let Some(state) = message.get("state")
            && is_down(number(&state["tool_level"]))
        {
            drawn.push([0, 1].map(|axis| number(&state["tool"][axis])));
        }
        assert!(
            message.get("fault").is_none_or(Value::is_null),
            "the job ends without a fault: {message}"
        );
        if message["notice"]["text"] == "The job is done." {
            return drawn;
        }
    }
}

#[test]
fn a_job_told_to_run_on_ends_though_its_page_is_closed_and_a_page_that_comes_back_has_control() {
    let server = Server::start();
    let mut watcher = server.page();
    let mut page = server.page();
    page.take_control_and_arm();
    load(&mut page);
    page.send(&json!({ "run_on": true }));
    run(&mut page);
    drop(page);
    let begun = time(&watcher.latest_state());
    let state = watcher.state("a second", |state| time(state) > begun + 1.0);
    assert_eq!(state["state"], "Running");
    assert!(state["run_on"] == true && number(&state["left"]) > 0.1);
    let mut again = server.page();
    again.state("control", |state| state["alive"] == true);
    drop(again);
    assert!(!drawn_to_the_end(&mut watcher).is_empty());
}

#[test]
fn a_plain_job_stops_with_its_page_and_goes_on_at_its_place() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    load(&mut page);
    run(&mut page);
    drop(page);
    let mut page = server.page();
    let fault = page.state_named("Fault");
    page.state("rest", |state| time(state) > time(&fault) + 1.0);
    page.take_control_and_arm();
    let line = number(&page.latest_state()["held"]);
    assert!((3.0..6.0).contains(&line), "line {line}");
    page.send(&json!("resume"));
    drawn_to_the_end(&mut page);
}

#[test]
fn a_stopped_job_goes_on_where_the_tool_was_lifted_though_the_arm_was_jogged_away() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    load(&mut page);
    run(&mut page);
    page.request("stop");
    notice(&mut page, "can be resumed");
    let lifted = page.state("the tool up", |state| state["tool_level"] == 0.0);
    let lifted = number(&lifted["tool"][0]);
    page.state_named("Armed");
    page.send(&json!({ "jog": [0.0, 0.01] }));
    let start = time(&page.latest_state());
    page.state("the jog", |state| time(state) > start + 0.7);
    page.send(&json!("resume"));
    let drawn = drawn_to_the_end(&mut page);
    // The stop took effect up to 35 ms before this state, and states come every 33 ms.
    let begun = drawn[0][0];
    assert!((begun - lifted).abs() < 8e-3, "{lifted} m, then {begun} m");
    let row = drawn[0][1];
    assert!(drawn.iter().all(|at| (at[1] - row).abs() < 1e-4));
}

#[test]
fn a_job_goes_on_after_an_emergency_stop_by_another_page() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    load(&mut page);
    page.send(&json!({ "run_on": true }));
    run(&mut page);
    let mut other = server.page();
    other.request("emergency_stop");
    page.state_named("Fault");
    page.take_control_and_arm();
    page.send(&json!("resume"));
    drawn_to_the_end(&mut page);
}

#[test]
fn a_job_starts_at_a_line_with_the_tool_up_on_the_way_there() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    load(&mut page);
    page.send(&json!({ "run_from": 99 }));
    notice(&mut page, "no motion at or behind line 99");
    page.send(&json!({ "run_from": 6 }));
    let drawn = drawn_to_the_end(&mut page);
    let [first, last] = [drawn[0][0], drawn[drawn.len() - 1][0]];
    assert!(first - last > 0.035, "from {first} m to {last} m");
    let back = |pair: &[[f64; 2]]| pair[1][0] <= pair[0][0] + 1e-5;
    assert!(drawn.windows(2).all(back), "one stroke to the left");
}

#[test]
fn a_share_of_the_feed_rate_takes_effect_within_a_second_and_a_half() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    let text = "G21 G90 F600\nM3\nG1 X80\nG1 X0\n";
    page.send(&json!({ "load": { "name": "slow", "text": text } }));
    page.wait("the job", |message| message.get("job").cloned());
    page.send(&json!("run"));
    let pace = |page: &mut Page| {
        let one = page.latest_state();
        let two = page.state("later", |state| time(state) > time(&one) + 0.3);
        let moved = number(&two["reference"][0]) - number(&one["reference"][0]);
        moved.abs() / (time(&two) - time(&one))
    };
    page.state("the feed rate", |state| state["tool_level"] == 1.0);
    let begun = time(&page.latest_state());
    page.state("the feed rate", |state| time(state) > begun + 0.5);
    let before = pace(&mut page);
    assert!((before - 0.01).abs() < 5e-4, "{before} m/s");
    page.send(&json!({ "feed": 2.0 }));
    let asked = time(&page.latest_state());
    page.state("its effect", |state| time(state) > asked + 1.5);
    let after = pace(&mut page);
    assert!((after - 0.02).abs() < 1e-3, "{after} m/s");
}

#[test]
fn the_time_of_a_job_and_the_time_left_are_those_of_its_run() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    // Circles and a zigzag, whose corners take most of the time.
    let zigzag: String = (0..100)
        .map(|i| format!("G1 X{} Y{}\n", 0.05 * f64::from(i), i % 2))
        .collect();
    let text = format!("G21 G90 F3000\nM3\nG2 X10 Y0 I5 J0\nG2 X0 Y0 I-5 J0\n{zigzag}");
    page.send(&json!({ "load": { "name": "strokes", "text": text } }));
    let planned = page.wait("its time", |message| {
        message.get("job")?.get("time")?.as_f64()
    });
    page.send(&json!("run"));
    let begun = page.state("the motion", |state| state["state"] == "Running");
    let half = page.state("a line of the zigzag", |state| {
        state["tag"].as_u64().is_some_and(|line| line > 45)
    });
    let end = page.state("its end", |state| state["left"].is_null());
    let took = time(&end) - time(&begun);
    // States come every 33 ms.
    assert!(
        (took - planned).abs() < 0.15,
        "{took} s, planned {planned} s"
    );
    let [left, was_left] = [number(&half["left"]), time(&end) - time(&half)];
    assert!(was_left > 2.0, "{was_left} s");
    assert!(
        (left - was_left).abs() < 0.25,
        "{left} s left, then {was_left} s"
    );
}

#[test]
fn the_working_mode_changes_through_a_stretched_leg_and_back() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    // From here leg 1 can be stretched, and the elbows cannot point inwards.
    page.send(&json!({ "follow": [-0.04, 0.18] }));
    let both = page.state("the ways", |state| {
        let there = number(&state["tool"][0]) < -0.0395;
        there
            && state["modes"]
                .as_array()
                .is_some_and(|modes| modes.len() == 2)
    });
    let place = [0, 1].map(|axis| number(&both["tool"][axis]));
    let modes = both["modes"].as_array().expect("modes").clone();
    let (own, other) = (both["elbows"].clone(), json!(["left", "left"]));
    assert!(modes.contains(&own) && modes.contains(&other), "{modes:?}");
    page.send(&json!({ "mode": ["left", "right"] }));
    notice(&mut page, "With elbow 1 left and elbow 4 right");
    for mode in [other, own] {
        page.send(&json!({ "mode": mode }));
        let changed = page.state("the mode", |state| {
            state["elbows"] == mode && state["state"] == "Armed" && !state["modes"].is_null()
        });
        for (axis, at) in place.iter().enumerate() {
            assert!((number(&changed["tool"][axis]) - at).abs() < 2e-4);
        }
    }
}

#[test]
fn a_job_waits_at_m0_with_the_tool_up_until_it_is_resumed_though_the_arm_was_jogged() {
    let server = Server::of("benchtop_pen", None);
    let mut page = server.page();
    page.take_control_and_arm();
    let text = "G21 G90 F3000\nM3\nG1 X40\nM0 (the red pen)\nG1 X0\nG1 X40\nM1\n";
    page.send(&json!({ "load": { "name": "two pens", "text": text } }));
    page.wait("the job", |message| message.get("job").cloned());
    page.send(&json!("run"));
    notice(&mut page, "M0: the red pen. The job waits");
    let paused = page.state("the pause", |state| state["pause"] == "M0: the red pen");
    assert_eq!(
        (&paused["state"], &paused["left"]),
        (&json!("Armed"), &Value::Null)
    );
    let until = time(&paused) + 1.0;
    let waiting = page.state("a second", |state| time(state) > until);
    assert_eq!(
        (&waiting["state"], number(&waiting["tool_level"]) < 0.01),
        (&json!("Armed"), true)
    );
    page.send(&json!({ "jog": [0.0, 0.01] }));
    let start = time(&waiting);
    page.state("the jog", |state| time(state) > start + 0.7);
    page.send(&json!("resume"));
    // The width of a servo's pulse is a whole number of counts.
    let drawn = drawn_with(&mut page, |level| level > 0.99);
    let [start, end] = [0, 1].map(|axis| number(&paused["tool"][axis]));
    assert!(
        (drawn[0][0] - start).hypot(drawn[0][1] - end) < 5e-3,
        "{:?}",
        drawn[0]
    );
    let state = page.latest_state();
    assert_eq!(state["pause"], Value::Null);
}

#[test]
fn the_pen_goes_down_and_up_where_the_arm_rests_and_a_jog_lifts_it() {
    let server = Server::of("benchtop_pen", None);
    let mut page = server.page();
    page.take_control_and_arm();
    let tool = page.latest_state()["tool"].clone();
    for (position, level) in [("down", 1.0), ("up", 0.0), ("down", 1.0)] {
        page.send(&json!({ "pen": position }));
        let state = page.state(position, |state| {
            state["state"] == "Armed" && (number(&state["tool_level"]) - level).abs() < 0.01
        });
        let moved = [0, 1].map(|axis| number(&state["tool"][axis]) - number(&tool[axis]));
        assert!(moved[0].hypot(moved[1]) < 1e-4, "{moved:?}");
    }
    page.state_named("Armed");
    page.send(&json!({ "jog": [0.02, 0.0] }));
    page.send(&json!({ "pen": "down" }));
    notice(&mut page, "The arm is moving");
    page.state("the pen up", |state| number(&state["tool_level"]) < 0.01);
}

#[test]
fn an_arm_without_a_pen_or_without_power_refuses_to_put_one_down() {
    let server = Server::start();
    let mut page = server.page();
    page.send(&json!("control"));
    page.send(&json!({ "pen": "down" }));
    notice(&mut page, "not armed");
    page.take_control_and_arm();
    page.send(&json!({ "pen": "down" }));
    notice(&mut page, "The arm has no pen");
}
