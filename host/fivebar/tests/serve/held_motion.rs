//! Motion for as long as a control is held.

use crate::lost_page::time_to_rest;
use crate::program::{Page, Server, number, speed, time};
use serde_json::{Value, json};

fn tool(state: &Value) -> [f64; 2] {
    [0, 1].map(|axis| number(&state["tool"][axis]))
}

fn hold(page: &mut Page, request: &Value) -> Value {
    page.send(request);
    page.state("the motion", |state| state["state"] == "Running")
}

#[test]
fn the_tool_moves_while_it_is_held_and_a_stop_ends_it() {
    let server = Server::start(&[]);
    let mut page = server.page();
    page.take_control_and_arm();
    let begun = hold(&mut page, &json!({ "hold": [0.03, 0.0] }));
    page.state("a second of it", |state| time(state) > time(&begun) + 1.0);
    page.request("stop");
    let asked = page.latest_state();
    let rest = page.state_named("Armed");
    assert!(time(&rest) - time(&asked) < 0.5, "it stops at once");
    let ([x, y], [end, same]) = (tool(&begun), tool(&rest));
    assert!((0.025..0.06).contains(&(end - x)), "{} m", end - x);
    assert!((same - y).abs() < 1e-4, "a straight line");
}

#[test]
fn the_arm_of_a_page_that_is_lost_while_it_holds_comes_to_rest() {
    let server = Server::start(&[]);
    let mut watcher = server.page();
    let mut page = server.page();
    page.take_control_and_arm();
    hold(&mut page, &json!({ "hold": [0.05, 0.0] }));
    page.state("the motion", |state| speed(state) > 0.1);
    let lost = watcher.latest_state();
    assert!(speed(&lost) > 0.1, "it moves");
    drop(page);
    let rests = time_to_rest(&mut watcher, time(&lost));
    assert!(rests < 0.7, "{rests} s");
}

#[test]
fn a_held_motion_ends_where_the_arm_can_go_no_farther_without_a_fault() {
    let server = Server::start(&[]);
    let mut page = server.page();
    page.take_control_and_arm();
    hold(&mut page, &json!({ "hold": [0.0, 0.25] }));
    page.state_named("Armed");
    page.send(&json!({ "hold": [0.0, 0.25] }));
    page.refused("as far that way as it can go");
    hold(&mut page, &json!({ "hold": [0.0, -0.25] }));
    page.request("stop");
    page.state_named("Armed");
}

#[test]
fn a_joint_turns_while_it_is_held_and_the_other_stays() {
    let server = Server::start(&[]);
    let mut page = server.page();
    page.take_control_and_arm();
    let angles = |state: &Value| [0, 1].map(|joint| number(&state["angle"][joint]));
    let request = json!({ "hold_joint": { "joint": "theta1", "rate": 0.2 } });
    let begun = hold(&mut page, &request);
    let later = page.state("a second of it", |state| time(state) > time(&begun) + 1.0);
    let ([before, other], [after, same]) = (angles(&begun), angles(&later));
    assert!(
        (0.15..0.25).contains(&(after - before)),
        "{} rad",
        after - before
    );
    assert!((other - same).abs() < 1e-3);
    page.request("stop");
    page.state_named("Armed");
}
