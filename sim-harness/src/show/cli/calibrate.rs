//! `fivebar calibrate`: lengths and joint offsets from a plate with known holes.

use super::failure::{Failure, refused};
use super::figures::figures;
use super::length::positive_length;
use super::rewrite::rewrite;
use super::say::{leave_output_to, print, say, warn};
use crate::input::measurements::read_columns;
use crate::input::robot::{BuiltIn, Robot};
use crate::show::files::write_whole;
use crate::show::picture::plate;
use crate::study::calibration::{
    answer, calibrate_robot, measured, proposal_answer, propose_poses, warnings,
};
use clap::ArgGroup;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Calibrates an arm: lengths, joint offsets and placement from touched holes of a plate.
///
/// The tip is put into holes whose places on the plate are known, and the counts are noted.
/// --propose lists the holes that determine the arm best.
#[derive(clap::Args)]
#[command(group = ArgGroup::new("what").args(["points", "propose"]).required(true))]
pub(super) struct Args {
    /// A robot file, or the name of a built-in robot.
    #[arg(long, value_name = "FILE", default_value = BuiltIn::DEFAULT)]
    robot: String,
    /// The touched holes: a table with the header counts1,counts4,x,y, in counts and in metres
    /// on the plate.
    #[arg(long, value_name = "FILE.csv")]
    points: Option<PathBuf>,
    /// Propose K holes, in the arm's own frame.
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(5..=400))]
    propose: Option<u16>,
    /// Standard deviation of a hole's x and of its y.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, default_value = "20um")]
    sigma: f64,
    /// Minimise the sum of squares in place of Huber's loss.
    #[arg(long, requires = "points")]
    plain: bool,
    /// Write the robot file with the measured values to FILE; a file that is there is kept as
    /// FILE.old.
    #[arg(long, value_name = "FILE", requires = "points")]
    out: Option<PathBuf>,
    /// Draw the plate with the proposed holes at true size.
    #[arg(long, value_name = "FILE.svg", requires = "propose")]
    plate: Option<PathBuf>,
    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.robot).map_err(refused)?;
    let answer = match (&args.points, args.propose) {
        (Some(points), _) => calibrated(args, &robot, points)?,
        (None, count) => proposed(args, &robot, count.unwrap_or(24).into())?,
    };
    if args.json {
        say(&answer)
    } else {
        print(figures(&answer))
    }
}

fn calibrated(args: &Args, robot: &Robot, points: &Path) -> Result<Value, Failure> {
    let rows = read_columns(points, ["counts1", "counts4", "x", "y"]).map_err(refused)?;
    let in_file = |error| refused(format_args!("{}: {error}", points.display()));
    let study = calibrate_robot(robot, &rows, args.sigma, !args.plain).map_err(in_file)?;
    for warning in warnings(robot, &study) {
        warn(format_args!("{}: {warning}", points.display()));
    }
    if let Some(out) = &args.out {
        rewrite(&args.robot, out, &measured(robot, &study))?;
    }
    Ok(answer(robot, &study))
}

fn proposed(args: &Args, robot: &Robot, count: usize) -> Result<Value, Failure> {
    let study = propose_poses(robot, count, args.sigma).map_err(refused)?;
    if let Some(path) = &args.plate {
        leave_output_to(path);
        write_whole(path, plate(&study.proposal.places)).map_err(refused)?;
    }
    Ok(proposal_answer(robot, &study))
}
