//! `fivebar workspace`: the map of an arm's workspace.

use super::failure::{Failure, refused};
use super::say::{print, say};
use super::value_error::ValueError;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_kinematics::five_bar::{Side, WorkingMode};
use fivebar_report::export::workspace_csv;
use fivebar_report::output::OutputFolder;
#[cfg(feature = "png")]
use fivebar_report::picture::png;
use fivebar_report::picture::svg;
use fivebar_report::study::workspace::WorkspaceStudy;
use fivebar_report::text;
use std::path::PathBuf;

/// Maps the workspace of an arm: areas, singularities, condition number.
///
/// Prints the areas and the largest clear rectangle of every branch. workspace.svg draws the map
/// of one working mode, workspace.csv lists the cells of all. A program built with
/// `--features png` draws workspace.png, too.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A robot file, or the name of a built-in robot.
    #[arg(default_value = BuiltIn::DEFAULT)]
    robot: String,
    /// The folder for workspace.svg and workspace.csv.
    #[arg(long, value_name = "DIR", default_value = "out/workspace")]
    out: PathBuf,
    /// The working mode to draw: the sides of elbows 1 and 4; by default the robot's own.
    #[arg(long, value_name = "ELBOW1,ELBOW4", value_parser = working_mode)]
    branch: Option<WorkingMode>,
    /// Side of a cell [mm]; by default it suits the arm's size.
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    resolution: Option<f64>,
    /// Print the figures as one JSON object.
    #[arg(long)]
    json: bool,
}

/// The names of the files, as a shell would write them.
const WRITTEN: &str = if cfg!(feature = "png") {
    "workspace.{svg,png,csv}"
} else {
    "workspace.{svg,csv}"
};

fn working_mode(text: &str) -> Result<WorkingMode, ValueError> {
    let side = |name: &str| match name.trim() {
        "left" => Some(Side::Left),
        "right" => Some(Side::Right),
        _ => None,
    };
    let sides = text.split_once(',');
    let sides = sides.and_then(|(first, second)| Some((side(first)?, side(second)?)));
    let (elbow1, elbow4) = sides.ok_or(ValueError::WorkingMode)?;
    Ok(WorkingMode::new(elbow1, elbow4))
}

/// Millimetres as metres.
fn millimetres(text: &str) -> Result<f64, ValueError> {
    let value: f64 = text.parse().map_err(|_| ValueError::Millimetres)?;
    if value > 0.0 && value.is_finite() {
        Ok(1e-3 * value)
    } else {
        Err(ValueError::PositiveMillimetres)
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.robot).map_err(refused)?;
    let folder = OutputFolder::prepare(&args.out, "--out").map_err(refused)?;
    let study = WorkspaceStudy::new(&robot, args.resolution).map_err(refused)?;
    let mode = args.branch.unwrap_or(robot.working_mode());
    let picture = svg(&study, mode).map_err(refused)?;
    let table = workspace_csv(&study);
    #[cfg(feature = "png")]
    let image = png(&picture).map_err(refused)?;
    let files: &[(&str, &dyn AsRef<[u8]>)] = &[
        ("workspace.svg", &picture),
        #[cfg(feature = "png")]
        ("workspace.png", &image),
        ("workspace.csv", &table),
    ];
    folder.write(files).map_err(refused)?;
    if args.json {
        let mut answer = study.answer();
        answer["out_dir"] = folder.path().display().to_string().into();
        say(&answer)?;
    } else {
        print(text::workspace(&study))?;
        say(format_args!(
            "wrote {}",
            folder.path().join(WRITTEN).display()
        ))?;
    }
    Ok(())
}
