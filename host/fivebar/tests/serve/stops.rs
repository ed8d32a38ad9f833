//! Stops that pages ask for.

use crate::in_process::{Page, Server};
use crate::state::{number, speed, time};
use serde_json::json;
use std::time::Duration;

const MS: Duration = Duration::from_millis(1);

/// Runs a job of lines to and fro, about half a minute long.
fn run_long_job(page: &mut Page) {
    let text = format!("G21 G90 F18000\nM3\n{}", "G1 X40\nG1 X0\n".repeat(60));
    page.send(&json!({ "load": { "name": "long", "text": text } }));
    page.send(&json!("run"));
    page.state("full speed", |state| {
        state["state"] == "Running" && speed(state) > 0.5
    });
}

#[test]
fn a_stop_drops_the_moves_that_were_asked_for_before_it() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    let before = page.latest_state();
    // Both arrive at once, and the stop overtakes the jog.
    let jog = page.begin(&json!({ "jog": [0.0, 0.02] }));
    page.begin(&json!({ "request": "stop" }));
    page.pass(500 * MS);
    let refused = page.take_answer(jog)["refused"].clone();
    assert_eq!(refused, "A stop was asked for after it.");
    let moved = number(&page.latest_state()["tool"][1]) - number(&before["tool"][1]);
    assert!(moved.abs() < 2e-3, "{moved} m");
}

#[test]
fn an_emergency_stop_is_latched_and_confirmed_in_every_state() {
    let server = Server::start();
    let mut page = server.page();
    let stop = |page: &mut Page, before: &str| {
        assert_eq!(page.latest_state()["state"], before);
        page.request("emergency_stop");
        page.stopped("emergency_stop");
        let state = page.latest_state();
        assert_eq!(
            (&state["state"], &state["fault"]),
            (&json!("Fault"), &json!(10))
        );
        assert_eq!(state["duty"], json!([0.0, 0.0]), "after {before}");
    };
    stop(&mut page, "Stopped");
    stop(&mut page, "Fault");
    page.request("clear_fault");
    page.pass(1100 * MS);
    page.request("home");
    stop(&mut page, "Homing");
    page.take_control_and_arm();
    stop(&mut page, "Armed");
    page.take_control_and_arm();
    run_long_job(&mut page);
    stop(&mut page, "Running");
    // A page that watches gets the confirmation, too, and a stop on the path is confirmed as well.
    page.take_control_and_arm();
    let mut watcher = server.page();
    page.request("stop");
    watcher.stopped("stop");
}

/// Messages come as fast as a program sends them, and clicks of one finger several times a second.
#[test]
fn after_a_fault_is_cleared_nothing_powers_the_motors_for_a_second() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    run_long_job(&mut page);
    page.request("emergency_stop");
    page.state("rest", |state| speed(state) < 0.05);
    page.request("clear_fault");
    let cleared = time(&page.latest_state());
    let refusal = |page: &mut Page, name: &str| {
        let refused = page.ask(&json!({ "request": name })).refused;
        refused.unwrap_or_default()
    };
    for request in ["arm", "home"] {
        assert!(refusal(&mut page, request).contains("cleared a moment ago"));
        page.send(&json!("resume"));
    }
    // Another page has no other right.
    let mut other = server.page();
    other.send(&json!("control"));
    while time(&other.latest_state()) < cleared + 0.85 {
        assert!(refusal(&mut other, "arm").contains("cleared a moment ago"));
    }
    other.pass(150 * MS);
    other.request("arm");
    other.state_named("Armed");
}
