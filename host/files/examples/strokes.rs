//! What a file draws, as points: `cargo run -p fivebar-files --example strokes FILE [PICTURE LEVEL]` prints a JSON list of its
//! strokes, each a list of [x, y] in millimetres. PICTURE is how a picture becomes strokes, such as `outline`, LEVEL the darkness
//! that becomes ink. The notes of the reader are on the standard error.

use fivebar_files::job::{Action, Job, JobOptions, Placement, Trace, read};
use std::path::Path;
use std::process::ExitCode;

/// Two strokes: a line, and a half circle.
const TWO: &str = "G21 G90 F600\nM3\nG1 X10\nM5\nG0 Y5\nM3\nG2 X0 Y5 I-5 J0\nM5\n";

/// Greatest length of the lines that take an arc's place [m].
const CHORD: f64 = 1e-4;

const AS_DRAWN: Placement = Placement {
    origin: [0.0; 2],
    scale: 1.0,
    turn: 0.0,
    home: [0.0; 2],
};

fn main() -> ExitCode {
    match print() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn print() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let text = match arguments.next() {
        Some(file) => read(Path::new(&file))?,
        None => TWO.into(),
    };
    let kind = arguments.next();
    let trace = kind.and_then(|kind| Trace::ALL.into_iter().find(|it| it.name() == kind));
    let level = arguments.next().map(|level| level.parse()).transpose()?;
    let options = JobOptions {
        trace,
        level,
        // Some programs write no F.
        speed_without_feed: Some(0.05),
        ..JobOptions::default()
    };
    let job = Job::parse_with(&text, &AS_DRAWN, &options)?;
    for note in &job.warnings {
        eprintln!("{note}");
    }
    println!("{}", serde_json::json!(strokes(&job)));
    Ok(())
}

fn strokes(job: &Job) -> Vec<Vec<[f64; 2]>> {
    let mut strokes: Vec<Vec<[f64; 2]>> = Vec::new();
    let (mut at, mut was_down) = ([0.0; 2], false);
    for step in &job.steps {
        let Some(to) = step.action.end() else {
            continue;
        };
        if step.draws() {
            if !was_down {
                strokes.push(vec![at]);
            }
            if let Some(stroke) = strokes.last_mut() {
                stroke.extend(points(at, &step.action));
                stroke.push(to);
            }
        }
        (at, was_down) = (to, step.draws());
    }
    let millimetres = |stroke: Vec<[f64; 2]>| stroke.into_iter().map(|at| at.map(|it| 1e3 * it));
    strokes
        .into_iter()
        .map(|it| millimetres(it).collect())
        .collect()
}

/// Points of an arc between its ends.
fn points(from: [f64; 2], action: &Action) -> Vec<[f64; 2]> {
    let Action::Arc {
        to,
        center,
        clockwise,
        ..
    } = *action
    else {
        return Vec::new();
    };
    let [start, end] = [from, to].map(|[x, y]| (y - center[1]).atan2(x - center[0]));
    let sense = if clockwise { -1.0 } else { 1.0 };
    let turn = match (sense * (end - start)).rem_euclid(std::f64::consts::TAU) {
        turn if turn < 1e-9 => std::f64::consts::TAU,
        turn => turn,
    };
    let radius = (from[0] - center[0]).hypot(from[1] - center[1]);
    let count = (radius * turn / CHORD).ceil() as u32;
    let at = |index: u32| {
        let angle = start + sense * turn * f64::from(index) / f64::from(count);
        [
            center[0] + radius * angle.cos(),
            center[1] + radius * angle.sin(),
        ]
    };
    (1..count).map(at).collect()
}
