//! `fivebar board-test`: what only silicon can show of a bare board.

use super::failure::{Failure, refused};
use super::port::PortArgs;
use super::say::{say, warn};
use super::value_error::ValueError;
use fivebar_report::output::OutputFolder;
use fivebar_report::pages;
use fivebar_sim::board_test::{Hands, run as test};
use serde_json::to_string_pretty;
use std::io::{BufRead, stdin};
use std::path::PathBuf;

/// Tests a bare board without motors: clocks, flash, converters, encoder inputs, stop, watchdog.
///
/// It says which wires to connect; a line `s` in place of Enter leaves a wire off, and its rows are then not
/// seen. It follows a small path with bridges on that drive nothing, and ends with a reset by the watchdog,
/// so that the board keeps the settings that it has stored. The status is 1 if a row has failed.
#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    port: PortArgs,
    /// How long the ticks are timed [s].
    #[arg(long, value_name = "N", default_value_t = 60.0, value_parser = seconds)]
    seconds: f64,
    /// The folder for report.html and board.json.
    #[arg(long, value_name = "DIR", default_value = "out/board-test")]
    out: PathBuf,
    /// Print the report as one JSON object; tasks and rows then go to the standard error.
    #[arg(long)]
    json: bool,
}

fn seconds(text: &str) -> Result<f64, ValueError> {
    let seconds = text.parse().ok();
    seconds
        .filter(|seconds| (0.1..=3600.0).contains(seconds))
        .ok_or(ValueError::Seconds)
}

/// Entered in place of an empty line: the wire stays off.
const LEAVE_OFF: &str = "s";

/// A person at the terminal.
struct Person {
    json: bool,
}

impl Person {
    fn print(&self, line: &str) {
        match self.json {
            true => warn(line),
            // A closed output changes nothing: the report follows.
            false => say(line).unwrap_or_default(),
        }
    }
}

impl Hands for Person {
    fn connect(&mut self, task: &str) -> bool {
        self.print(&format!("→ {task}, then press Enter."));
        let mut line = String::new();
        // Where the input ends, nobody connects anything.
        let read = stdin().lock().read_line(&mut line);
        read.is_ok_and(|bytes| bytes > 0) && line.trim() != LEAVE_OFF
    }

    fn report(&mut self, line: &str) {
        self.print(line);
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let folder = OutputFolder::prepare(&args.out, "--out").map_err(refused)?;
    let (mut client, identity) = args.port.open()?;
    let mut person = Person { json: args.json };
    let report = test(&mut client, &identity, &mut person, args.seconds).map_err(refused)?;
    let json = to_string_pretty(&report).map_err(refused)?;
    folder
        .write(&[
            ("report.html", &pages::board_test(&report).render()),
            ("board.json", &json),
        ])
        .map_err(refused)?;
    if args.json {
        say(serde_json::to_string(&report).map_err(refused)?)?;
    } else {
        say(format_args!("{}", args.out.join("report.html").display()))?;
    }
    let failed: Vec<String> = report
        .failed()
        .filter_map(|row| {
            let (why, remedy) = row.verdict.reason()?;
            Some(format!("{}: {why}. To do: {remedy}.", row.name))
        })
        .collect();
    match failed.is_empty() {
        true => Ok(()),
        false => Err(refused(failed.join("\n"))),
    }
}
