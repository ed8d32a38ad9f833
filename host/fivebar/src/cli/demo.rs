//! `fivebar` without a command: the demonstration, a drawing job on the default arm.

use super::failure::{Failure, refused};
use super::output::OutputArgs;
use super::repeat::RepeatArgs;
use super::say::say;
use super::sim;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_files::scenario::Scenario;

#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    output: OutputArgs,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(BuiltIn::DEFAULT).map_err(refused)?;
    let scenario = Scenario::demonstration(robot);
    sim::simulate(&scenario, &args.output, false, &RepeatArgs::default())?;
    if !args.output.json {
        say(format_args!(
            "\nOpen the report in a browser. `fivebar sim JOB.gcode` draws your own job; \
             `fivebar help` lists all commands."
        ))?;
    }
    Ok(())
}
