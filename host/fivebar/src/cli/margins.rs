//! `fivebar margins`: how far the position loop is from instability.

use super::failure::{Failure, refused};
use super::say::{print, say};
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_report::output::write_in;
use fivebar_report::study::margins::MarginsStudy;
use fivebar_report::{pages, text};
use std::path::PathBuf;

/// Computes how far the position loop is from instability, over the workspace.
///
/// The loop is the complete sampled one: observer, delays, current loop, springs of the drives; with drives on a CAN bus, the
/// bus and the drives' own loops.
/// The margins printed are those of the worst pose. The status is 1 if the loop is unstable there.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A robot file, or the name of a built-in robot.
    #[arg(default_value = BuiltIn::DEFAULT)]
    robot: String,
    /// Also write the Bode and sensitivity plots as DIR/report.html.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the figures as one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.robot).map_err(refused)?;
    robot.with_known_torque().map_err(refused)?;
    let study = MarginsStudy::new(&robot).map_err(refused)?;
    if let Some(folder) = &args.out {
        write_in(folder, "report.html", pages::margins(&study).render()).map_err(refused)?;
    }
    if args.json {
        say(study.answer())?;
    } else {
        print(text::margins(&study))?;
    }
    match study.worst().margins {
        Some(_) => Ok(()),
        None => Err(refused(format_args!(
            "the position loop of `{}` is unstable at θ1 = {:.3} rad, θ4 = {:.3} rad",
            robot.name,
            study.worst().theta[0],
            study.worst().theta[1]
        ))),
    }
}
