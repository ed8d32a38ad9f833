//! `fivebar identify`: masses and friction from a log of motion.

use super::failure::{Failure, refused};
use super::figures::figures;
use super::rewrite::rewrite;
use super::say::{leave_output_to, print, say, warn};
use crate::input::measurements::read_columns;
use crate::input::robot::{BuiltIn, Robot};
use crate::run::excitation::excite;
use crate::show::export::motion_csv;
use crate::show::files::write_whole;
use crate::study::identification::{
    answer, identify_robot, measured, proposal_answer, propose_for, warning,
};
use clap::ArgGroup;
use fivebar_plant::Mismatch;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Identifies an arm: its base parameters and friction from a log of its motion.
///
/// --propose gives a trajectory that excites the arm within its limits; the log of ten periods
/// of it determines all parameters.
#[derive(clap::Args)]
#[command(group = ArgGroup::new("what").args(["log", "propose", "simulate"]).required(true))]
pub(super) struct Args {
    /// A robot file, or the name of a built-in robot.
    #[arg(long, value_name = "FILE", default_value = BuiltIn::DEFAULT)]
    robot: String,
    /// The log: a table with the columns time_s, theta1_rad, theta4_rad, current1_a and
    /// current4_a and a row for every tick.
    #[arg(long, value_name = "FILE.csv")]
    log: Option<PathBuf>,
    /// Propose excitations: one to identify, one to validate.
    #[arg(long)]
    propose: bool,
    /// Simulate ten periods of the first proposed excitation on the arm with the declared
    /// mismatch, and write the log.
    #[arg(long, value_name = "FILE.csv")]
    simulate: Option<PathBuf>,
    /// Write the robot file with the measured friction and masses to FILE; a file that is there is kept as
    /// FILE.old.
    #[arg(long, value_name = "FILE", requires = "log")]
    out: Option<PathBuf>,
    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

/// Periods of a simulated log.
const PERIODS: u32 = 10;

const COLUMNS: [&str; 5] = [
    "time_s",
    "theta1_rad",
    "theta4_rad",
    "current1_a",
    "current4_a",
];

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.robot).map_err(refused)?;
    let answer = if let Some(log) = &args.log {
        identified(args, &robot, log)?
    } else {
        let proposed = propose_for(&robot).map_err(refused)?;
        if let Some(log) = &args.simulate {
            leave_output_to(log);
            let excitation = &proposed[0].excitation;
            let rows = excite(&robot, excitation, PERIODS, &Mismatch::default(), 1);
            write_whole(log, motion_csv(&rows.map_err(refused)?)).map_err(refused)?;
        }
        proposal_answer(&robot, &proposed)
    };
    if args.json {
        say(&answer)
    } else {
        print(figures(&answer))
    }
}

fn identified(args: &Args, robot: &Robot, log: &Path) -> Result<Value, Failure> {
    let rows = read_columns(log, COLUMNS).map_err(refused)?;
    let found = identify_robot(robot, &rows)
        .map_err(|error| refused(format_args!("{}: {error}", log.display())))?;
    if let Some(warning) = warning(robot, &found) {
        warn(format_args!("{}: {warning}", log.display()));
    }
    if let Some(out) = &args.out {
        rewrite(&args.robot, out, &measured(robot, &found))?;
    }
    Ok(answer(robot, rows.len(), &found))
}
