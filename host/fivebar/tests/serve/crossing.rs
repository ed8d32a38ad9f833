//! Jobs that cross to the other assembly mode.

use crate::in_process::{Page, Server};
use crate::state::number;
use serde_json::{Value, json};

/// Home of the arm [mm] becomes its place in the frame of the base.
const FRAME: &str = "G21 G90 F6000\nM3 S1\nM5\nG53 G0 X0 Y0\nG92 X39.916 Y163.354\n";

fn server() -> Server {
    let robot = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../files/robots/short_couplers.toml"
    );
    Server::of(robot, None)
}

fn load(page: &mut Page, text: &str) -> Value {
    let text = format!("{FRAME}{text}");
    page.send(&json!({ "load": { "name": "crossing", "text": text } }));
    page.wait("the job", |message| message.get("job").cloned())
}

fn notice(page: &mut Page, words: &str) {
    page.wait(words, |message| {
        assert!(message.get("fault").is_none_or(Value::is_null), "{message}");
        let text = message.get("notice")?.get("text")?.as_str()?;
        text.contains(words).then_some(())
    });
}

/// Where the tool was down until the job was done [m].
fn drawn_to_the_end(page: &mut Page) -> Vec<[f64; 2]> {
    let mut drawn = Vec::new();
    loop {
        let message = page.next();
        if let Some(state) = message.get("state")
            && state["tool_level"] != 0.0
        {
            drawn.push([0, 1].map(|axis| number(&state["tool"][axis])));
        }
        let text = message["notice"]["text"].as_str().unwrap_or_default();
        assert!(
            !text.contains("stopped") && message["notice"]["refused"] != true,
            "{text}"
        );
        if text == "The job is done." {
            return drawn;
        }
    }
}

/// Whether a point [m] was drawn at.
fn at(drawn: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    drawn
        .iter()
        .any(|place| (place[0] - x).hypot(place[1] - y) < 2e-3)
}

#[test]
fn a_job_that_crosses_there_and_back_is_drawn_to_its_end() {
    let server = server();
    let mut page = server.page();
    page.take_control_and_arm();
    let job = load(
        &mut page,
        "G0 X60 Y115\nM781 X30 Y12 P0.3\nM3\nG1 X33 Y12 F2000\nG1 X30 Y12\nM5\n\
         M781 X60 Y115 P0.3\nM3\nG1 X55 Y115\nM5\n",
    );
    assert_eq!(job["refusal"], Value::Null);
    page.send(&json!("run"));
    let drawn = drawn_to_the_end(&mut page);
    for place in [[0.032, 0.012], [0.057, 0.115]] {
        assert!(at(&drawn, place), "{place:?} in {drawn:?}");
    }
}

#[test]
fn a_job_stopped_on_a_crossing_and_behind_it_goes_on_in_the_other_assembly_mode() {
    let server = server();
    let mut page = server.page();
    page.take_control_and_arm();
    load(
        &mut page,
        "G0 X60 Y115\nG1 X60 Y116\nM781 X30 Y12 P0.3\nM3\nG1 X33 Y12 F200\nM5\n",
    );
    page.send(&json!({ "run_from": 10 }));
    notice(&mut page, "Line 10 is drawn in the other assembly mode");
    page.send(&json!("run"));
    // A stop on the way takes effect where the crossing ends.
    page.state_named("Crossing");
    page.request("stop");
    notice(&mut page, "can be resumed");
    page.state_named("Armed");
    page.send(&json!("resume"));
    notice(&mut page, "goes on");
    page.state("the line behind it", |state| state["tool_level"] != 0.0);
    page.request("stop");
    notice(&mut page, "can be resumed");
    page.state_named("Armed");
    page.send(&json!("resume"));
    let drawn = drawn_to_the_end(&mut page);
    assert!(at(&drawn, [0.032, 0.012]), "{drawn:?}");
}
