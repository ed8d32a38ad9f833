//! `fivebar identify`: masses and friction from a log of motion.

use super::failure::{Failure, refused};
use super::figures::figures;
use super::rewrite::rewrite;
use super::say::{leave_output_to, print, say, warn};
use clap::ArgGroup;
use fivebar_files::measurements::read_columns;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_plant::Mismatch;
use fivebar_report::export::{motion_columns, motion_csv};
use fivebar_report::output::write_whole;
use fivebar_report::study::identification::{
    PERIODS, StudyError, answer, identify_robot, measured, measured_payload, payload_answer,
    payload_of, proposal_answer, propose_for, validation_answer, validations, warning,
};
use fivebar_report::text;
use fivebar_sim::excitation::excite;
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
    /// current4_a and a row for every tick; of drives on a CAN bus torque1_nm and torque4_nm in the place of the currents.
    #[arg(long, value_name = "FILE.csv")]
    log: Option<PathBuf>,
    /// Propose excitations: one to identify, one to validate.
    #[arg(long)]
    propose: bool,
    /// Simulate ten periods of a proposed excitation, the first without --second, on the arm with the declared
    /// mismatch, and write the log.
    #[arg(long, value_name = "FILE.csv")]
    simulate: Option<PathBuf>,
    /// A second log, of another trajectory: how well its torques are predicted, by what the first
    /// one gave and by the robot file.
    #[arg(long, value_name = "FILE.csv", requires = "log", conflicts_with_all = ["propose", "simulate"])]
    validate: Option<PathBuf>,
    /// Find the payload only, with the masses of the robot file; any quick motion will do.
    #[arg(long, requires = "log", conflicts_with_all = ["validate", "propose", "simulate"])]
    payload: bool,
    /// With --simulate: the second proposed excitation, to validate with, in place of the first.
    #[arg(long, requires = "simulate", conflicts_with_all = ["log", "propose"])]
    second: bool,
    /// Write the robot file with the measured friction and masses, or the payload, to FILE; a file
    /// that is there is kept as FILE.old.
    #[arg(long, value_name = "FILE", requires = "log")]
    out: Option<PathBuf>,
    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.robot).map_err(refused)?;
    robot.with_known_torque().map_err(refused)?;
    match &args.log {
        Some(log) if args.payload => payload_found(args, &robot, log),
        Some(log) => identified(args, &robot, log),
        None => proposed(args, &robot),
    }
}

fn proposed(args: &Args, robot: &Robot) -> Result<(), Failure> {
    let proposed = propose_for(robot).map_err(refused)?;
    if let Some(log) = &args.simulate {
        leave_output_to(log);
        let excitation = &proposed[usize::from(args.second)].excitation;
        let columns = motion_columns(robot.drive_kind());
        let rows = excite(robot, excitation, PERIODS, &Mismatch::default(), 1);
        write_whole(log, motion_csv(columns, &rows.map_err(refused)?)).map_err(refused)?;
    }
    let answer = proposal_answer(robot, &proposed);
    if args.json {
        say(&answer)
    } else {
        print(figures(&answer))
    }
}

fn identified(args: &Args, robot: &Robot, log: &Path) -> Result<(), Failure> {
    let rows = read_columns(log, motion_columns(robot.drive_kind())).map_err(refused)?;
    let found = identify_robot(robot, &rows).map_err(|error| in_file(log, &error))?;
    if let Some(warning) = warning(robot, &found) {
        warn(format_args!("{}: {warning}", log.display()));
    }
    let predicted = match &args.validate {
        Some(second) => {
            if second == log {
                warn("--validate: the same log predicts itself; give one of another trajectory");
            }
            let rows = read_columns(second, motion_columns(robot.drive_kind())).map_err(refused)?;
            let predicted = validations(robot, &found, &rows);
            Some(predicted.map_err(|error| in_file(second, &error))?)
        }
        None => None,
    };
    if let Some(out) = &args.out {
        rewrite(&args.robot, out, &measured(robot, &found))?;
    }
    if args.json {
        let mut answer = answer(robot, rows.len(), &found);
        if let Some(predicted) = predicted {
            answer["validation"] = validation_answer(predicted);
        }
        return say(&answer);
    }
    print(text::identification(&robot.name, rows.len(), &found))?;
    predicted.map_or(Ok(()), |predicted| print(text::validation(&predicted)))
}

fn payload_found(args: &Args, robot: &Robot, log: &Path) -> Result<(), Failure> {
    let rows = read_columns(log, motion_columns(robot.drive_kind())).map_err(refused)?;
    let found = payload_of(robot, &rows).map_err(|error| in_file(log, &error))?;
    if let Some(out) = &args.out {
        rewrite(&args.robot, out, &[measured_payload(&found)])?;
    }
    if args.json {
        say(payload_answer(robot, rows.len(), &found))
    } else {
        print(text::payload(&robot.name, rows.len(), &found))
    }
}

fn in_file(path: &Path, error: &StudyError) -> Failure {
    refused(format_args!("{}: {error}", path.display()))
}
