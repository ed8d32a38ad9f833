//! A hand that leads the arm for a page.

use crate::arms::ARMS;
use crate::in_process::{HANDLED, Page, Server};
use crate::kinds::robot;
use crate::state::number;
use fivebar_sim::controller::Hand;
use serde_json::{Value, json};
use std::time::Duration;

const MS: Duration = Duration::from_millis(1);

/// 10 mm along x, then along −y, and back in 3 s.
fn hand() -> Hand {
    Hand::parse("1,0.01,0\n2,0.01,-0.01\n3,0,0\n").expect("a hand")
}

/// A page in control whose arm a hand leads from now on.
fn led(hand: &Hand) -> (Server, Page) {
    let server = Server::led(robot("benchtop"), hand);
    let mut page = server.page();
    page.take_control_and_arm();
    page.accepted(&json!({ "teach": true }));
    page.state_named("Compliant");
    hand.grip();
    (server, page)
}

fn tool(state: &Value) -> [f64; 2] {
    [0, 1].map(|axis| number(&state["tool"][axis]))
}

/// The job that the page is told of.
fn job(page: &mut Page) -> Value {
    page.wait("the job", |message| message.get("job").cloned())
}

#[test]
fn what_a_hand_teaches_becomes_the_job_and_is_drawn() {
    let hand = hand();
    let (_server, mut page) = led(&hand);
    let [x, y] = tool(&page.latest_state());
    page.pass(1000 * MS);
    let [x1, y1] = tool(&page.latest_state());
    assert!(
        (x1 - x - 0.01).abs() < 1e-3 && (y1 - y).abs() < 1e-3,
        "{x1} {y1}"
    );
    page.pass(2300 * MS);
    // Nothing else moves the arm meanwhile.
    for request in [
        json!("run"),
        json!({ "jog": [1e-3, 0.0] }),
        json!({ "pen": "down" }),
    ] {
        let refused = page.ask(&request).refused.expect("a refusal");
        assert!(refused.contains("A hand leads the arm"), "{refused}");
    }
    page.accepted(&json!({ "teach": false }));
    let job = job(&mut page);
    assert_eq!(job["name"], "taught.gcode");
    assert!(job["refused"].is_null(), "{job}");
    page.state_named("Armed");
    page.accepted(&json!("run"));
    let (mut right, mut low) = (f64::NEG_INFINITY, f64::INFINITY);
    loop {
        let message = page.next();
        if let Some(state) = message.get("state") {
            let [x, y] = tool(state);
            (right, low) = (right.max(x), low.min(y));
        }
        if message["notice"]["text"] == "The job is done." {
            break;
        }
    }
    assert!((right - x - 0.01).abs() < 5e-4, "{right} {x}");
    assert!((low - y + 0.01).abs() < 5e-4, "{low} {y}");
}

#[test]
fn a_lost_page_and_a_stop_hold_the_arm_and_an_emergency_stop_switches_it_off() {
    for end in ["stop", "emergency_stop", "lost"] {
        let hand = hand();
        let (server, mut page) = led(&hand);
        page.pass(1500 * MS);
        let mut asked_at = None;
        if end == "lost" {
            drop(page);
            page = server.page();
        } else {
            // Its answer comes within this time, and says which tick was the last one before it.
            asked_at = Some(page.request(end).tick as f64);
        }
        let name = if end == "emergency_stop" {
            "Fault"
        } else {
            "Armed"
        };
        let off = json!([0.0, 0.0]);
        let rest = page.state(name, |state| {
            state["state"] == name && (name == "Armed" || state["duty"] == off)
        });
        let fault = &rest["fault"];
        assert_eq!(fault.is_null(), end != "emergency_stop", "{end}: {fault}");
        if let (Some(before), "emergency_stop") = (asked_at, end) {
            let ticks = number(&rest["tick"]);
            let tick = number(&rest["time"]) / ticks;
            let took = HANDLED.as_secs_f64() + tick * (ticks - before);
            // States come 30 times a second.
            assert!(took < 0.05 + 1.0 / 30.0, "{took} s");
        }
    }
}

#[test]
fn arms_that_no_hand_leads_say_why() {
    for name in ARMS {
        let server = Server::of_robot(robot(name));
        let mut page = server.page();
        page.take_control_and_arm();
        // Holding brakes release, and hobby servos come up.
        page.pass(1500 * MS);
        let asked = page.ask(&json!({ "teach": true })).refused;
        let is_led = name == "benchtop";
        assert_eq!(asked.is_none(), is_led, "{name}: {asked:?}");
        assert!(
            asked
                .as_ref()
                .is_none_or(|why| why.contains("a hand leads arms with brushed motors")),
            "{name}: {asked:?}"
        );
        let refused = page.ask(&json!({ "teach": false })).refused;
        assert_eq!(refused.is_none(), is_led, "{name}: {refused:?}");
    }
}
