//! `fivebar doctor`: what is installed, what is missing, how to get it.

use super::failure::{Failure, refused};
use super::say::say;
use crate::show::doctor::{Check, State, Task, examine};
use clap::ValueEnum;
use serde_json::json;

/// Tells what this machine has, what is missing and how to get it.
///
/// Nothing of it is needed to simulate and analyse, so that the exit status is 0 whatever is
/// missing; name what you want to do, and it is 1 if something needed for that is missing or
/// outdated.
#[derive(clap::Args)]
pub(super) struct Args {
    /// What you want to do.
    tasks: Vec<Task>,
    /// Print what was found as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let checks = examine();
    let in_the_way: Vec<&str> = checks
        .iter()
        .filter(|check| check.is_in_the_way_of(&args.tasks))
        .map(|check| check.what)
        .collect();
    if args.json {
        let answer = json!({
            "asked": args.tasks,
            "ready": in_the_way.is_empty(),
            "checks": checks,
        });
        say(&answer)?;
    } else {
        for check in &checks {
            say(told(check))?;
        }
    }
    if in_the_way.is_empty() {
        Ok(())
    } else {
        let wanted: Vec<String> = args.tasks.iter().map(|task| name(*task)).collect();
        Err(refused(format_args!(
            "missing or outdated for {}: {}",
            wanted.join(" and "),
            in_the_way.join(", ")
        )))
    }
}

fn told(check: &Check) -> String {
    let Check { what, purpose, .. } = check;
    let tasks: Vec<String> = check.needed_for.iter().map(|task| name(*task)).collect();
    let tasks = match tasks.as_slice() {
        [] => String::new(),
        tasks => format!(" (for {})", tasks.join(", ")),
    };
    match &check.state {
        State::Found(found) => format!("found    {what:<22} {purpose}{tasks}\n         {found}"),
        State::Missing(way) => {
            format!("missing  {what:<22} {purpose}{tasks}\n         get it: {way}")
        }
        State::Outdated(why) => format!("outdated {what:<22} {purpose}{tasks}\n         {why}"),
    }
}

/// A task as it is typed.
fn name(task: Task) -> String {
    let value = task.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().into())
}
