//! Jobs that run as time-optimal motions.

use crate::in_process::{Page, Server};
use crate::state::{number, time};
use serde_json::{Value, json};

/// Strokes of 40 mm to and fro at 10 mm/s, which would take minutes.
fn load(page: &mut Page, strokes: usize) {
    let text = format!("G21 G90 F600\nM3\n{}", "G1 X40\nG1 X0\n".repeat(strokes));
    page.send(&json!({ "load": { "name": "strokes", "text": text } }));
    let job = page.wait("the job", |message| message.get("job").cloned());
    assert_eq!(job["refusal"], Value::Null);
}

fn notice(page: &mut Page, words: &str) {
    page.wait(words, |message| {
        assert!(message.get("fault").is_none_or(Value::is_null), "{message}");
        let text = message.get("notice")?.get("text")?.as_str()?;
        text.contains(words).then_some(())
    });
}

/// The job's time that has passed [s]. A state that is older than the job has none.
fn progress(state: &Value) -> f64 {
    state["progress"][0].as_f64().unwrap_or_default()
}

/// The mean speed of the job: its time that passes in a time of the controller.
fn pace(page: &mut Page) -> f64 {
    let [begin, end] = [0.25, 0.5].map(|wait| {
        let start = time(&page.latest_state());
        page.state("some time", |state| time(state) > start + wait)
    });
    let passed = |state: &Value| number(&state["progress"][0]);
    (passed(&end) - passed(&begin)) / (time(&end) - time(&begin))
}

#[test]
fn a_job_runs_at_the_arms_limit_and_goes_on_after_a_stop_and_slows_on_demand() {
    let server = Server::of("benchtop", Some(0.6));
    let mut page = server.page();
    page.take_control_and_arm();
    page.send(&json!({ "feed": 1.5 }));
    notice(&mut page, "choose 100 %");
    load(&mut page, 40);
    page.send(&json!("run"));
    notice(&mut page, "has started");
    let running = page.state("strokes", |state| progress(state) > 0.1);
    let all = number(&running["progress"][1]);
    assert!(all < 10.0, "{all} s for 3.2 m");
    let fast = pace(&mut page);
    assert!((fast - 1.0).abs() < 0.1, "{fast}");
    page.send(&json!({ "feed": 0.5 }));
    let slow = pace(&mut page);
    assert!((slow - 0.5).abs() < 0.1, "{slow}");
    page.request("stop");
    notice(&mut page, "can be resumed");
    let stopped = page.state_named("Armed");
    let done = number(&stopped["progress"][0]);
    page.send(&json!({ "jog": [0.0, 0.01] }));
    let start = time(&page.latest_state());
    page.state("the jog", |state| time(state) > start + 0.4);
    page.send(&json!({ "feed": 1.0 }));
    page.send(&json!("resume"));
    notice(&mut page, "goes on");
    let resumed = page.state("motion", |state| progress(state) > done + 0.2);
    let left = number(&resumed["progress"][1]);
    assert!((left - all).abs() < 0.5, "{left} s of {all} s");
    page.request("stop");
    notice(&mut page, "can be resumed");
    page.state_named("Armed");
    page.send(&json!({ "run_from": 78 }));
    notice(&mut page, "goes on");
    notice(&mut page, "The job is done.");
}

#[test]
fn a_job_rests_at_m0_and_the_rest_of_it_is_planned_when_it_is_resumed() {
    let server = Server::of("benchtop", Some(0.6));
    let mut page = server.page();
    page.take_control_and_arm();
    let text = "G21 G90 F600\nM3\nG1 X20\nM0\nG1 X40\nM0\nG1 X0\n";
    page.send(&json!({ "load": { "name": "three pens", "text": text } }));
    page.wait("the job", |message| message.get("job").cloned());
    page.send(&json!("run"));
    for _ in 0..2 {
        notice(&mut page, "M0. The job waits");
        let paused = page.state("the pause", |state| state["pause"] == "M0");
        assert_eq!(
            (&paused["state"], &paused["tool_level"]),
            (&json!("Armed"), &json!(0.0))
        );
        page.send(&json!("resume"));
        notice(&mut page, "goes on");
    }
    notice(&mut page, "The job is done");
}
