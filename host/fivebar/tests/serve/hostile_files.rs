//! Files whose reading does not end, while the arm is armed.

use crate::in_process::{HANDLED, Server};
use crate::state::{number, time};
use fivebar_files::job::{Job, JobError, JobOptions, JobReader, Placement};
use serde_json::json;
use std::sync::Barrier;

/// Passed when the reading of a job begins, and when it may end.
static READING: [Barrier; 2] = [Barrier::new(2), Barrier::new(2)];

/// Lets the reading end, also if a test fails.
struct EndsReading;

impl Drop for EndsReading {
    fn drop(&mut self) {
        READING[1].wait();
    }
}

fn without_end(text: &str, placement: &Placement, options: &JobOptions) -> Result<Job, JobError> {
    for barrier in &READING {
        barrier.wait();
    }
    Job::parse_with(text, placement, options)
}

#[test]
fn while_a_file_is_read_without_end_an_emergency_stop_takes_effect_within_100_ms_of_the_arms_time()
{
    let server = Server::reading_by(JobReader(without_end));
    let mut page = server.page();
    page.take_control_and_arm();
    page.send(&json!({ "load": { "name": "hostile", "text": "G21 F600\nG1 X1\n" } }));
    READING[0].wait();
    let ends = EndsReading;
    page.send(&json!({ "jog": [0.0, 0.005] }));
    page.state("a move", |state| state["state"] == "Running");
    // Its answer comes within this time, and says which state before it does not show it.
    let answer = page.request("emergency_stop");
    let stopped = page.state_named("Fault");
    assert_eq!(stopped["duty"], json!([0.0, 0.0]), "the bridges are off");
    let ticks = number(&stopped["tick"]);
    let tick = time(&stopped) / ticks;
    let took = HANDLED.as_secs_f64() + tick * (ticks - answer.tick as f64);
    assert!(took < 0.1, "{took} s");
    drop(ends);
    // The job is there when its reader ends.
    page.wait("the job", |message| {
        (message.get("job")?["name"] == "hostile").then_some(())
    });
}
