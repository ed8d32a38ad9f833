//! `fivebar plan`: time-optimal motion along a path.

use super::failure::{Failure, refused};
use super::say::say;
use super::value_error::ValueError;
use crate::input::path_case::PathCase;
use crate::input::robot::{BuiltIn, Robot};
use crate::study::plan::PlanStudy;
use std::path::PathBuf;

/// Plans the fastest motion along a path that the limits of the arm allow.
///
/// The path file holds a path of lines, arcs and Fourier series, the working mode and the limits
/// of torque, speed and acceleration; docs/time-optimal.md describes it.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A built-in robot or a robot file; by default the one that the path file names.
    #[arg(long, value_name = "FILE")]
    robot: Option<String>,
    /// The path, its working mode and its limits, in JSON.
    #[arg(long, value_name = "FILE.json")]
    path: PathBuf,
    /// The share of the torque limits that the plan uses; the rest is kept for feedback.
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = share)]
    torque_share: f64,
    /// Print the plan as one JSON object.
    #[arg(long)]
    json: bool,
}

fn share(text: &str) -> Result<f64, ValueError> {
    let value: f64 = text.parse().map_err(|_| ValueError::Share)?;
    if value > 0.0 && value <= 1.0 {
        Ok(value)
    } else {
        Err(ValueError::Share)
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let case = PathCase::read(&args.path).map_err(refused)?;
    let named = args.robot.as_deref().or(case.robot.as_deref());
    let robot = Robot::load(named.unwrap_or(BuiltIn::DEFAULT)).map_err(refused)?;
    let study = PlanStudy::new(&robot, &case, args.torque_share).map_err(refused)?;
    if args.json {
        return say(study.answer());
    }
    for (n, run) in study.runs.iter().enumerate() {
        let (length, time) = (run.length, run.time);
        say(format_args!(
            "run {}: length {length:.6}, {time:.6} s",
            n + 1
        ))?;
    }
    let (share, excess) = (100.0 * study.active_share(), 100.0 * study.limit_excess());
    say(format_args!(
        "motion {:.6} s, planned in {:.2} ms\na limit is above 95 % for {share:.1} % of the time, \
         and passed by {excess:.3} % at most",
        study.time(),
        1e3 * study.planning.as_secs_f64(),
    ))
}
