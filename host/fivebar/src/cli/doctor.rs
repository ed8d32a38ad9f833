//! `fivebar doctor`: checks of the tools and devices that some commands need.

use super::failure::{Failure, refused};
use super::say::say;
use crate::doctor::{Check, State, Task, examine};
use clap::ValueEnum;
use serde_json::json;

/// Lists what this computer has, what is missing and how to get it.
///
/// Simulations and analyses need none of it, so the exit status is 0. With TASKS it is 1 if
/// something that these tasks need is missing or outdated.
#[derive(clap::Args)]
pub(super) struct Args {
    /// The tasks to check for.
    tasks: Vec<Task>,
    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let checks = examine();
    let blocking: Vec<&str> = checks
        .iter()
        .filter(|check| check.blocks(&args.tasks))
        .map(|check| &*check.what)
        .collect();
    if args.json {
        let answer = json!({
            "asked": args.tasks,
            "ready": blocking.is_empty(),
            "checks": checks,
        });
        say(&answer)?;
    } else {
        for check in &checks {
            say(text(check))?;
        }
    }
    if blocking.is_empty() {
        Ok(())
    } else {
        let wanted: Vec<String> = args.tasks.iter().map(|task| name(*task)).collect();
        Err(refused(format_args!(
            "missing or outdated for {}: {}",
            wanted.join(" and "),
            blocking.join(", ")
        )))
    }
}

fn text(check: &Check) -> String {
    let Check { what, purpose, .. } = check;
    let tasks: Vec<String> = check.needed_for.iter().map(|task| name(*task)).collect();
    let tasks = match tasks.as_slice() {
        [] => String::new(),
        tasks => format!(" (for {})", tasks.join(", ")),
    };
    match &check.state {
        State::Found(found) => format!("found    {what:<22} {purpose}{tasks}\n         {found}"),
        State::Missing(remedy) => {
            format!("missing  {what:<22} {purpose}{tasks}\n         to get it: {remedy}")
        }
        State::Outdated(why) => format!("outdated {what:<22} {purpose}{tasks}\n         {why}"),
    }
}

/// The name of a task on the command line.
fn name(task: Task) -> String {
    let value = task.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().into())
}
