//! The heights of the pen are tried with the motors off and kept; macros; the line of a job under the pointer.

use crate::in_process::{Page, Server};
use crate::own_job::notice;
use crate::state::number;
use fivebar_files::robot::{BuiltIn, Robot};
use serde_json::{Value, json};

fn is_at(state: &Value, pen: [f64; 2]) -> bool {
    (0..2).all(|height| (number(&state["pen"][height]) - pen[height]).abs() < 1e-7)
}

fn try_height(page: &mut Page, pen: &str, width: f64) -> Option<String> {
    page.ask(&json!({ "pen_height": { "pen": pen, "width": width } }))
        .refused
}

#[test]
fn heights_are_tried_with_the_motors_off_only_and_the_file_gets_both_when_they_are_kept() {
    let server = Server::of("benchtop_pen", None);
    let mut page = server.page();
    page.send(&json!("control"));
    let refused = page.ask(&json!("keep_pen")).refused;
    assert!(refused.expect("a refusal").contains("move a slider first"));
    assert_eq!(try_height(&mut page, "down", 1.734_56e-3), None);
    page.state("the height", |state| is_at(state, [1e-3, 1.73e-3]));
    assert_eq!(try_height(&mut page, "up", 0.9e-3), None);
    for (pen, width, why) in [
        ("up", 5.1e-3, "0.1 to 5 ms"),
        ("up", 1.73e-3, "must differ"),
    ] {
        let refused = try_height(&mut page, pen, width).expect("a refusal");
        assert!(refused.contains(why), "{refused}");
    }
    page.accepted(&json!("keep_pen"));
    let kept = server.kept.lock().expect("no panic").clone();
    let wanted = ["up_width", "down_width"].map(|key| format!("ToolOutput({key:?})"));
    assert_eq!(
        kept,
        [
            format!("{} = 9.00e-4", wanted[0]),
            format!("{} = 1.73e-3", wanted[1])
        ]
    );
    page.take_control_and_arm();
    let state = page.latest_state();
    assert!(is_at(&state, [0.9e-3, 1.73e-3]), "{state}");
    let refused = try_height(&mut page, "up", 1e-3).expect("a refusal");
    assert!(refused.contains("with the motors off"), "{refused}");
}

#[test]
fn a_trial_that_is_not_kept_ends_where_the_arm_is_homed_or_the_page_is_lost() {
    let server = Server::of("benchtop_pen", None);
    let mut page = server.page();
    page.send(&json!("control"));
    assert_eq!(try_height(&mut page, "down", 2e-3), None);
    page.state("the trial", |state| is_at(state, [1e-3, 2e-3]));
    page.take_control_and_arm();
    let state = page.latest_state();
    assert!(is_at(&state, [1e-3, 1.5e-3]), "{state}");
    page.request("disarm");
    page.state_named("Stopped");
    assert_eq!(try_height(&mut page, "down", 2e-3), None);
    drop(page);
    let mut page = server.page();
    page.state("the settings", |state| is_at(state, [1e-3, 1.5e-3]));
}

#[test]
fn an_arm_without_a_servo_has_no_heights() {
    let server = Server::start();
    let mut page = server.page();
    page.send(&json!("control"));
    let refused = try_height(&mut page, "up", 1e-3).expect("a refusal");
    assert!(refused.contains("no pen with a servo"), "{refused}");
    assert_eq!(page.latest_state()["pen"], Value::Null);
}

fn with_macros() -> Server {
    let text = BuiltIn::find("benchtop_pen").expect("a robot").text;
    let macros = "[macros]\nmark = \"\"\"G21 G90 F3000\nG0 X10 Y0\nM3\nG1 X20\nM5\nG0 X0 Y0\"\"\"\naway = \"G0 X900\"\n";
    let robot = Robot::parse("arm.toml", &format!("{text}\n{macros}")).expect("a robot");
    Server::of_robot(robot)
}

#[test]
fn a_macro_is_checked_as_a_whole_then_done_and_a_stop_ends_it() {
    let server = with_macros();
    let mut page = server.page();
    page.send(&json!("control"));
    let refused = page
        .ask(&json!({ "macro": "mark" }))
        .refused
        .expect("a refusal");
    assert!(refused.contains("not armed"), "{refused}");
    page.take_control_and_arm();
    let start = page.latest_state()["tool"].clone();
    let from_start = |state: &Value, by: f64| {
        let [x, y] = [0, 1].map(|axis| number(&state["tool"][axis]) - number(&start[axis]));
        (x - by).hypot(y) < 1e-3
    };
    page.accepted(&json!({ "macro": "away" }));
    let away = page.wait("a notice", |message| message.get("notice").cloned());
    assert!(away.to_string().contains("away: Line 1"), "{away}");
    page.accepted(&json!({ "macro": "nothing" }));
    notice(&mut page, "no such macro");
    assert!(from_start(&page.latest_state(), 0.0));
    page.accepted(&json!({ "macro": "mark" }));
    let is_down = |state: &Value| number(&state["tool_level"]) > 0.9;
    page.state("the pen down", |state| {
        is_down(state) && from_start(state, 0.01)
    });
    page.state("the stroke's end", |state| {
        is_down(state) && from_start(state, 0.02)
    });
    page.state("the end", |state| {
        state["state"] == "Armed" && !is_down(state) && from_start(state, 0.0)
    });
    page.state("rest", |state| state["pending"] == false);
    page.accepted(&json!({ "macro": "mark" }));
    page.state("the pen down", is_down);
    page.send(&json!({ "request": "stop" }));
    let stopped = page.state("rest", |state| {
        state["state"] == "Armed" && state["pending"] == false
    });
    assert!(
        !is_down(&stopped) && !from_start(&stopped, 0.0),
        "{stopped}"
    );
}

#[test]
fn a_job_begins_at_the_line_under_the_pointer_with_the_pen_up_and_the_units_and_feed_of_that_line()
{
    let server = Server::of("benchtop_pen", None);
    let mut page = server.page();
    page.take_control_and_arm();
    // Inches and a slow feed from line 5 on.
    let text = "G21 G90 F6000\nM3\nG1 X20\nM5\nG20 F20\nG0 X0 Y0.2\nM3\nG1 X0.5\nM5\n";
    page.accepted(&json!({ "load": { "name": "two lines", "text": text } }));
    let strokes = page.wait("the job", |message| {
        message["job"]["time"].as_f64()?;
        message["job"]["strokes"].as_array().cloned()
    });
    let drawn: Vec<_> = strokes
        .iter()
        .filter(|stroke| stroke["down"] == true)
        .collect();
    let [from, to] = [0, 1].map(|end| [0, 1].map(|axis| number(&drawn[1]["points"][end][axis])));
    let far = |value: &Value, point: [f64; 2]| {
        (number(&value[0]) - point[0]).hypot(number(&value[1]) - point[1])
    };
    // 1.5 mm beside the second stroke, which lies 5 mm above the first.
    page.accepted(&json!({ "line_at": [0.5 * (from[0] + to[0]), from[1] - 1.5e-3] }));
    let line = page.wait("the line", |message| message.get("line").cloned());
    assert_eq!(line["line"], 8);
    assert!(far(&line["at"], from) < 1e-6, "{line}");
    page.accepted(&json!({ "run_from": line["line"] }));
    let is_down = |state: &Value| number(&state["tool_level"]) > 0.9;
    let down = page.state("the pen down", is_down);
    assert!(far(&down["tool"], from) < 2e-4, "{down}");
    let up = page.state("the pen up", |state| !is_down(state));
    assert!(far(&up["tool"], to) < 2e-4, "{up}");
    // 0.5 in at 20 in/min take 1.5 s.
    let time = number(&up["time"]) - number(&down["time"]);
    assert!((1.4..2.0).contains(&time), "{time}");
}
