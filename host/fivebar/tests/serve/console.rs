//! The console of a page: lines of G-code, answered as by the bridge.

use crate::in_process::{Page, Server};
use crate::state::{number, speed, time};
use serde_json::{Value, json};

fn say(page: &mut Page, line: &str) {
    page.send(&json!({ "console": line }));
}

/// What the console answers, up to these words.
fn answer(page: &mut Page, words: &str) -> String {
    let mut text = String::new();
    while !text.contains(words) {
        text += &page.wait(words, |message| {
            Some(message.get("console")?.get("text")?.as_str()?.to_owned())
        });
    }
    text
}

fn tool(state: &Value) -> [f64; 2] {
    [0, 1].map(|axis| number(&state["tool"][axis]))
}

#[test]
fn the_console_answers_as_the_bridge_and_its_page_can_go_on_with_other_controls() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    let before = tool(&page.latest_state());
    say(&mut page, "$I");
    let greeting = answer(&mut page, "ok");
    assert!(greeting.contains("Grbl 1.1h ["), "{greeting}");
    say(&mut page, "G91 G1 X-10 F3000");
    answer(&mut page, "ok");
    let moved = page.state("10 mm", |state| tool(state)[0] < before[0] - 0.0099);
    assert!(moved["console"].is_u64() && moved["sender"] == true);
    page.state_named("Armed");
    say(&mut page, "G1 X900");
    let refused = answer(&mut page, "error:15");
    assert!(refused.contains("[MSG:"), "{refused}");
    say(&mut page, "G1 X1 Đ");
    page.refused("ASCII characters only");
    // A stop at rest leaves the console as it is.
    page.request("stop");
    page.wait("the stop", |message| message.get("stopped").map(|_| ()));
    say(&mut page, "G4 P0.01");
    answer(&mut page, "ok");
    say(&mut page, "?");
    assert!(answer(&mut page, ">").contains("|MPos:"));
    // A jog ends the console, which forgets G91.
    let rests = tool(&page.latest_state())[0];
    page.send(&json!({ "jog": [0.005, 0.0] }));
    page.state("the jog", |state| tool(state)[0] > rests + 0.0049);
    let state = page.state_named("Armed");
    assert!(state["console"].is_null() && state["sender"] == false);
    say(&mut page, "$G");
    assert!(answer(&mut page, "ok").contains("G90"));
}

#[test]
fn a_page_stops_its_console_and_other_pages_and_senders_cannot_use_it() {
    let server = Server::start();
    let mut page = server.page();
    page.take_control_and_arm();
    let mut other = server.page();
    say(&mut other, "G91 G1 X-10 F3000");
    other.refused("take control first");
    say(&mut page, "G91 G1 X-60 F600");
    page.state_named("Running");
    page.send(&json!({ "jog": [0.005, 0.0] }));
    page.refused("lines are in progress");
    page.request("stop");
    page.state_named("Armed");
    let rests = tool(&page.latest_state())[0];
    say(&mut page, "~");
    page.state("the rest of the line", |state| {
        tool(state)[0] < rests - 0.002
    });
    page.request("stop");
    page.state_named("Armed");
    page.send(&json!({ "jog": [0.001, 0.0] }));
    page.state("the jog", |state| state["console"].is_null());
}

#[test]
fn the_arm_rests_when_the_page_of_a_console_is_lost() {
    let server = Server::start();
    let mut watcher = server.page();
    let mut page = server.page();
    page.take_control_and_arm();
    say(&mut page, "G91 G1 X-60 F2400");
    page.state("the motion", |state| speed(state) > 0.1);
    let lost = time(&watcher.latest_state());
    drop(page);
    let rest = watcher.state("rest", |state| {
        time(state) > lost + 0.7 || state["state"] == "Armed"
    });
    assert_eq!(rest["state"], "Armed");
    let mut again = server.page();
    again.take_control_and_arm();
    let there = |state: &Value| number(&state["tool"][0]);
    let before = there(&again.latest_state());
    again.accepted(&json!({ "jog": [0.001, 0.0] }));
    again.state("the jog", |state| there(state) - before > 0.9e-3);
}
