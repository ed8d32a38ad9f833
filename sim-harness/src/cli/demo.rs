//! Bare `fivebar`: the demonstration, a drawing job done by the default arm.

use super::{Failure, sim};
use crate::robot::{BuiltIn, Robot};
use crate::run::Scenario;
use std::path::PathBuf;

/// The job, which comes with the program.
const JOB: &str = include_str!("../../jobs/fivebar.gcode");

#[derive(clap::Args)]
pub(super) struct Args {
    /// The folder for the demonstration's report.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Print the figures as one JSON object.
    #[arg(long)]
    json: bool,
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
    sim::simulate(&scenario(robot), &args.out, args.json)?;
    if !args.json {
        println!(
            "\nOpen the report in a browser. `fivebar sim JOB.gcode` draws a job of yours, \
             `fivebar help` tells what else there is."
        );
    }
    Ok(())
}
