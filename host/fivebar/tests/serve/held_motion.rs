//! Motion for as long as a control is held.

use crate::in_process::{Page, Server};
use crate::state::{number, speed, time};
use serde_json::{Value, json};
use std::time::Duration;

const MS: Duration = Duration::from_millis(1);

fn tool(state: &Value) -> [f64; 2] {
    [0, 1].map(|axis| number(&state["tool"][axis]))
}

/// A server, and a page in control of an arm whose motors are on.
fn armed() -> (Server, Page) {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    (server, page)
}

/// Begins a motion that the page renews from now on.
fn hold(page: &mut Page, request: &Value) -> Value {
    page.renews = Some(page.accepted(request).number);
    page.state_named("Running")
}

#[test]
fn the_tool_moves_while_it_is_held_and_a_stop_ends_it() {
    let (_server, mut page) = armed();
    let begun = hold(&mut page, &json!({ "hold": [0.03, 0.0] }));
    page.pass(1000 * MS);
    page.request("stop");
    let asked = page.latest_state();
    let rest = page.until_rest();
    assert!(time(&rest) - time(&asked) < 0.3, "it stops at once");
    let ([x, y], [end, same]) = (tool(&begun), tool(&rest));
    assert!((0.03..0.04).contains(&(end - x)), "{} m", end - x);
    assert!((same - y).abs() < 1e-4, "a straight line");
}

/// How far the tool goes until it rests [m].
fn goes(page: &mut Page, begun: &Value) -> f64 {
    let rest = page.until_rest();
    assert_eq!(rest["fault"], Value::Null, "it stops on its path");
    tool(&rest)[0] - tool(begun)[0]
}

#[test]
fn a_motion_that_is_not_renewed_ends_after_150_ms() {
    let (_server, mut page) = armed();
    let begun = page.latest_state();
    page.accepted(&json!({ "hold": [0.04, 0.0] }));
    // 0.1 s later.
    let moving = page.latest_state();
    assert_eq!(moving["state"], "Running", "the first 150 ms are given");
    // Handled, 150 ms, noticed within a turn of 10 ms; then a ramp of 0.1 s.
    let most = 0.04 * (0.03 + 0.15 + 0.02 + 0.1);
    let moved = goes(&mut page, &begun);
    assert!((0.04 * 0.1..most).contains(&moved), "{moved} m");
}

#[test]
fn the_first_renewal_that_stays_out_ends_a_motion_that_was_renewed_for_long() {
    let (_server, mut page) = armed();
    hold(&mut page, &json!({ "hold": [0.01, 0.0] }));
    page.pass(1500 * MS);
    let last = page.latest_state();
    assert_eq!(last["state"], "Running");
    page.renews = None;
    let moved = goes(&mut page, &last);
    assert!((0.0..0.01 * 0.4).contains(&moved), "{moved} m");
}

#[test]
fn neither_another_page_nor_an_older_hold_renews_a_motion() {
    let (server, mut page) = armed();
    let mut watcher = server.page();
    let begun = page.latest_state();
    let held = page.accepted(&json!({ "hold": [0.04, 0.0] })).number;
    watcher.renews = Some(held);
    let moved = goes_while_both_live(&mut page, &mut watcher, &begun);
    assert!(moved < 0.04 * 0.35, "another page renews it: {moved} m");
    let begun = page.latest_state();
    page.accepted(&json!({ "hold": [-0.04, 0.0] }));
    page.renews = Some(held);
    let moved = goes(&mut page, &begun);
    assert!(
        (-0.04 * 0.35..-1e-3).contains(&moved),
        "the older one does: {moved} m"
    );
}

fn goes_while_both_live(page: &mut Page, other: &mut Page, begun: &Value) -> f64 {
    for _ in 0..20 {
        page.pass(20 * MS);
        other.pass(20 * MS);
    }
    goes(page, begun)
}

/// The page is still connected, as when its machine has lost its power.
#[test]
fn the_arm_of_a_silent_page_that_holds_a_control_rests_before_the_page_counts_as_lost() {
    let (server, mut page) = armed();
    let mut watcher = server.page();
    hold(&mut page, &json!({ "hold": [0.03, 0.0] }));
    let last = watcher.latest_state();
    assert!(speed(&last) > 0.1, "it moves");
    let rest = watcher.state("rest", |state| {
        time(state) > time(&last) + 0.5 || state["state"] == "Armed"
    });
    assert!(time(&rest) - time(&last) < 0.5, "{rest}");
    assert_eq!(
        (&rest["state"], &rest["fault"]),
        (&"Armed".into(), &Value::Null)
    );
}

#[test]
fn the_arm_of_a_page_that_is_closed_while_it_holds_a_control_rests_at_once() {
    let (server, mut page) = armed();
    let mut watcher = server.page();
    hold(&mut page, &json!({ "hold": [0.03, 0.0] }));
    let last = watcher.latest_state();
    assert!(speed(&last) > 0.1, "it moves");
    drop(page);
    let rest = watcher.state("rest", |state| speed(state) < 0.01);
    let moved = tool(&rest)[0] - tool(&last)[0];
    assert!(moved < 0.03 * 0.4, "{moved} m");
}

#[test]
fn a_held_motion_ends_where_the_arm_can_go_no_farther_without_a_fault() {
    let (_server, mut page) = armed();
    hold(&mut page, &json!({ "hold": [0.0, 0.25] }));
    page.until_rest();
    let refused = page.ask(&json!({ "hold": [0.0, 0.25] })).refused;
    assert!(refused.unwrap().contains("as far that way as it can go"));
    hold(&mut page, &json!({ "hold": [0.0, -0.25] }));
    page.request("stop");
    page.until_rest();
}

/// A motion that ended by itself is held no more: nothing is left that could stop the next one.
#[test]
fn what_follows_a_held_motion_at_its_end_is_not_stopped() {
    let (_server, mut page) = armed();
    hold(&mut page, &json!({ "hold": [0.0, 0.25] }));
    let end = page.until_rest();
    page.renews = None;
    page.accepted(&json!({ "jog": [0.0, -0.05] }));
    let rest = page.until_rest();
    let moved = tool(&rest)[1] - tool(&end)[1];
    assert!((moved + 0.05).abs() < 1e-4, "{moved} m");
}

#[test]
fn a_joint_turns_while_it_is_held_and_the_other_stays() {
    let (_server, mut page) = armed();
    let angles = |state: &Value| [0, 1].map(|joint| number(&state["angle"][joint]));
    let request = json!({ "hold_joint": { "joint": "theta1", "rate": 0.2 } });
    hold(&mut page, &request);
    page.pass(200 * MS);
    let begun = page.latest_state();
    page.pass(1000 * MS);
    let later = page.latest_state();
    let passed = time(&later) - time(&begun);
    let ([before, other], [after, same]) = (angles(&begun), angles(&later));
    let turned = after - before;
    assert!(
        (0.85..1.05).contains(&(turned / (0.2 * passed))),
        "{turned} rad in {passed} s"
    );
    assert!((other - same).abs() < 1e-3);
    page.request("stop");
    page.until_rest();
}
