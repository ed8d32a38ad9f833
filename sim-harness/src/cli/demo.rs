//! Bare `fivebar`: the demonstration, a drawing job done by the default arm.

use super::output::OutputArgs;
use super::{Failure, sim};
use crate::robot::{BuiltIn, Robot};
use crate::run::Scenario;

/// The job, which comes with the program.
const JOB: &str = include_str!("../../jobs/fivebar.gcode");

#[derive(clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    output: OutputArgs,
}

/// The demonstration, done by this arm.
pub(super) fn scenario(robot: Robot) -> Scenario {
    Scenario::new(
        "the demonstration",
        robot,
        "the demonstration job",
        JOB.into(),
    )
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot =
        Robot::load(BuiltIn::DEFAULT).map_err(|error| Failure::Refused(error.to_string()))?;
    sim::simulate(&scenario(robot), &args.output)?;
    if !args.output.json {
        println!(
            "\nOpen the report in a browser. `fivebar sim JOB.gcode` draws a job of yours, \
             `fivebar help` tells what else there is."
        );
    }
    Ok(())
}
