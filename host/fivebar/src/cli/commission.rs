//! `fivebar commission`: the steps of a commissioning at the terminal.

use super::failure::{Failure, refused};
use super::port::interrupted;
use super::say::{say, warn};
use crate::commission::{Commissioning, Options, Output, StepError, named, names};
use fivebar_files::robot::BuiltIn;
use std::io::{BufRead, stdin};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

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
    match named(text) {
        Some(name) => Ok(name.into()),
        None => Err(format!("a step is one of {}", names().join(", "))),
    }
}

/// How often a wait for Enter looks for the end of the program.
const LOOK: Duration = Duration::from_millis(50);

/// A person at the terminal, who presses Enter when a task is done. The simulated operator presses nothing.
struct Terminal {
    /// A line that was entered; it ends with the input.
    entered: Receiver<String>,
    ends: Arc<AtomicBool>,
}

impl Terminal {
    /// Reads the input in a thread of its own, so that a signal ends a wait for Enter.
    fn new(ends: Arc<AtomicBool>) -> Self {
        let (enter, entered) = sync_channel(0);
        thread::spawn(move || {
            for line in stdin().lock().lines().map_while(Result::ok) {
                if enter.send(line).is_err() {
                    return;
                }
            }
        });
        Self { entered, ends }
    }

    /// The line that is entered next.
    fn wait(&self) -> Result<String, StepError> {
        while !self.ends.load(Ordering::Acquire) {
            match self.entered.recv_timeout(LOOK) {
                Ok(line) => return Ok(line),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(StepError::other(
                        "the input ended while a step waited for Enter; run the same command again to go on",
                    ));
                }
            }
        }
        Err(StepError::other("stopped by the user"))
    }
}

impl Output for Terminal {
    fn report(&mut self, line: &str) -> Result<(), StepError> {
        print(format_args!("  {line}"))
    }

    fn ask(&mut self, task: &str, simulated: bool) -> Result<(), StepError> {
        if simulated {
            return Ok(());
        }
        print(format_args!("  → {task}, then press Enter."))?;
        self.wait().map(|_| ())
    }

    fn choose(&mut self, question: &str, answers: &[String]) -> Result<usize, StepError> {
        print(format_args!("  → {question}"))?;
        for (index, answer) in answers.iter().enumerate() {
            print(format_args!("     {}  {answer}", index + 1))?;
        }
        loop {
            print("    Enter its number.")?;
            let number = self.wait()?.trim().parse::<usize>();
            if let Ok(number) = number
                && (1..=answers.len()).contains(&number)
            {
                return Ok(number - 1);
            }
        }
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let ends = interrupted()?;
    commission(args, &ends).map_err(refused)
}

fn commission(args: &Args, ends: &Arc<AtomicBool>) -> Result<(), StepError> {
    let options = Options {
        port: args.port.clone(),
        robot: args.robot.clone(),
        scenario: args.scenario.clone(),
        out: args.out.clone(),
        points: args.points.clone(),
    };
    let terminal = Terminal::new(Arc::clone(ends));
    let mut commissioning = Commissioning::open(&options, Box::new(terminal), Arc::clone(ends))?;
    let outcome = steps(args, &mut commissioning);
    if outcome.is_err() {
        let is_off = match ends.load(Ordering::Acquire) {
            true => commissioning.switch_off(),
            false => commissioning.switch_off_if_on(),
        };
        is_off.unwrap_or_else(|error| {
            warn(format_args!("the bridges may be on: {error}"));
        });
    }
    outcome
}

/// Does the steps that are not done yet.
fn steps(args: &Args, commissioning: &mut Commissioning) -> Result<(), StepError> {
    if let Some(again) = &args.again {
        commissioning.forget_from(again)?;
    }
    let until = args.until.as_deref();
    let until = until.map(|step| commissioning.place(step)).transpose()?;
    commissioning.prepare()?;
    let all = commissioning.steps();
    for (index, step) in all.iter().enumerate() {
        if until == Some(index) {
            break;
        }
        let title = format!("{}/{} {}", index + 1, all.len(), step.name);
        if let Some(done) = commissioning.done(step.name) {
            print(format_args!(
                "{title}: done on {}: {}",
                done.date, done.found
            ))?;
            continue;
        }
        print(format_args!("{title}: {}", step.does))?;
        commissioning.run(step)?;
        if let Some(done) = commissioning.done(step.name) {
            print(format_args!("  {} {}", done.sign(), done.found))?;
        }
    }
    print(commissioning.files())
}

fn print(line: impl std::fmt::Display) -> Result<(), StepError> {
    say(line).map_err(StepError::other)
}
