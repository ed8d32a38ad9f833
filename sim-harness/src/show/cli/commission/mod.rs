//! `fivebar commission`: from a new arm to one that knows itself, step by step.

mod bench;
mod finding;
mod log;
mod operator;
mod record;
mod simulated;
mod steps;
mod witness;

use super::failure::{Failure, refused};
use super::say::say;
use crate::input::robot::{BuiltIn, Robot, measured_text, text_of, today};
use crate::input::scenario::Scenario;
use crate::run::link::{Client, SerialLine};
use bench::{Bench, Line};
use finding::StepError;
use operator::Operator;
use record::{Done, Record};
use std::path::PathBuf;
use steps::{STEPS, Step};

/// Puts a new arm into operation step by step: checks its wiring, measures it, and writes its
/// robot file.
///
/// Each step says what it does, does the smallest safe thing and judges it. A step that finds a
/// mistake names it and what to change; the same command then goes on where it stopped.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The controller's serial port, or `simulated` for the simulated arm.
    #[arg(long)]
    port: String,
    /// A robot file, or the name of a built-in robot.
    #[arg(long, value_name = "FILE", default_value = BuiltIn::DEFAULT)]
    robot: String,
    /// With `--port simulated`: how the arm differs from the robot file, and how it is wired.
    #[arg(long, value_name = "SCENARIO.toml")]
    scenario: Option<String>,
    /// The folder of the record and of the robot file with the measured values.
    #[arg(long, value_name = "DIR", default_value = "commissioning")]
    out: PathBuf,
    /// Holes that were touched before, in place of the step geometry's: a table as for
    /// `fivebar calibrate`.
    #[arg(long, value_name = "FILE.csv")]
    points: Option<PathBuf>,
    /// Do this step and those after it again.
    #[arg(long, value_name = "STEP", value_parser = step_name)]
    again: Option<String>,
    /// Stop before this step.
    #[arg(long, value_name = "STEP", value_parser = step_name)]
    until: Option<String>,
}

fn step_name(text: &str) -> Result<String, String> {
    if STEPS.iter().any(|step| step.name == text) {
        return Ok(text.into());
    }
    let names: Vec<&str> = STEPS.iter().map(|step| step.name).collect();
    Err(format!("a step is one of {}", names.join(", ")))
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    commission(args).map_err(refused)
}

fn commission(args: &Args) -> Result<(), StepError> {
    let drawing = text_of(&args.robot).map_err(StepError::other)?;
    let drawn = Robot::load(&args.robot).map_err(StepError::other)?;
    let mut record = Record::open(&args.out, &args.robot, &drawing)?;
    if let Some(again) = &args.again {
        let from = STEPS
            .iter()
            .position(|step| step.name == again)
            .unwrap_or(0);
        let names: Vec<&str> = STEPS[from..].iter().map(|step| step.name).collect();
        record.forget_from(&names);
    }
    let mut text = record.robot_text()?.unwrap_or(drawing);
    let file = record.robot_path().display().to_string();
    let robot = Robot::parse(&file, &text).map_err(StepError::other)?;
    if robot.actuators.is_none() {
        return Err(StepError::Other(format!(
            "robot `{}` has no [[actuator]]: an arm with motors needs both",
            robot.name
        )));
    }
    let (line, operator) = connect(args, &drawn)?;
    let (client, _) = Client::open(line)?;
    let mut bench = Bench::new(client, operator, drawn, robot, args.points.clone())?;
    bench.placement = record.placement();
    bench.clear_and_upload()?;
    for (index, step) in STEPS.iter().enumerate() {
        if args.until.as_deref() == Some(step.name) {
            break;
        }
        let title = format!("{}/{} {}", index + 1, STEPS.len(), step.name);
        if let Some(done) = record.done(step.name) {
            print(format_args!(
                "{title}: done on {}: {}",
                done.date, done.found
            ))?;
            continue;
        }
        print(format_args!("{title}: {}", step.does))?;
        text = one(step, &mut bench, &mut record, &file, text)?;
    }
    print(format_args!(
        "the record and robot.toml are in {}",
        args.out.display()
    ))
}

/// Does a step and writes what it found; returns the robot file.
fn one(
    step: &Step,
    bench: &mut Bench,
    record: &mut Record,
    file: &str,
    text: String,
) -> Result<String, StepError> {
    bench.operator.begin_step(step.name);
    let outcome = (step.run)(bench).inspect_err(|_| bench.tell_fault());
    if let Some(seen) = bench.operator.witnessed()? {
        record.write_simulated(&seen)?;
    }
    let outcome = outcome?;
    print(format_args!("  ✓ {}", outcome.found))?;
    let new = match &outcome.measured[..] {
        [] => None,
        values => Some(measured_text(file, &text, values).map_err(|error| {
            StepError::Other(format!(
                "the measured values make no valid robot file: {error}"
            ))
        })?),
    };
    if let Some(picture) = &outcome.picture {
        record.draw(step.name, picture)?;
    }
    let done = Done {
        step: step.name.into(),
        date: today(),
        found: outcome.found,
        values: outcome.values,
    };
    record.add(done, new.as_deref())?;
    bench.placement = record.placement();
    if let Some(new) = new {
        bench.robot = Robot::parse(file, &new).map_err(StepError::other)?;
        bench.upload()?;
        return Ok(new);
    }
    Ok(text)
}

fn connect(args: &Args, drawn: &Robot) -> Result<(Box<dyn Line>, Operator), StepError> {
    if args.port != "simulated" {
        if args.scenario.is_some() {
            return Err(StepError::other("--scenario is for --port simulated"));
        }
        let line = SerialLine::open(&args.port).map_err(StepError::other)?;
        return Ok((Box::new(line), Operator::Person));
    }
    let scenario = match &args.scenario {
        Some(file) => Scenario::load(file).map_err(StepError::other)?,
        None => Scenario::demonstration(drawn.clone()),
    };
    let (line, hand) = simulated::arm(&scenario, drawn)?;
    Ok((Box::new(line), Operator::Simulated(hand)))
}

fn print(line: impl std::fmt::Display) -> Result<(), StepError> {
    say(line).map_err(|_| StepError::other("the output is closed"))
}
