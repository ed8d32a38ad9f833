//! `fivebar calibrate`: lengths and joint offsets from what was measured.

use super::failure::{Failure, refused};
use super::length::positive_length;
use super::rewrite::rewrite;
use super::say::{leave_output_to, print, say, warn};
use clap::ArgGroup;
use fivebar_design::calibration::{Criterion, Deviations};
use fivebar_files::measurements::read_columns;
use fivebar_files::robot::{BuiltIn, Robot};
use fivebar_report::output::write_whole;
use fivebar_report::picture::{plate, tip_errors};
use fivebar_report::study::calibration::{
    Rows, answer, calibrate_robot, calibrate_robot_mixed, measured, mixed_answer, mixed_warnings,
    proposal_answer, propose_poses, warnings,
};
use fivebar_report::text::{Calibrated, calibration, proposal};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Calibrates an arm: lengths, joint offsets and placement from what was measured.
///
/// The tip is put into holes whose places on a plate are known, and the counts are noted.
/// --propose lists the holes that determine the arm best. Known distances, holes at unknown places
/// and photographs of what the tip drew serve in place of the plate or beside it.
#[derive(clap::Args)]
#[command(group = ArgGroup::new("what")
    .args(["points", "bars", "holes", "photo", "propose"])
    .multiple(true)
    .required(true))]
pub(super) struct Args {
    /// A robot file, or the name of a built-in robot.
    #[arg(long, value_name = "FILE", default_value = BuiltIn::DEFAULT)]
    robot: String,
    /// The touched holes: a table with the header counts1,counts4,x,y, in counts and in metres
    /// on the plate.
    #[arg(long, value_name = "FILE.csv")]
    points: Option<PathBuf>,
    /// Known distances between two places of the tip, as of a ball-bar: a table with the header
    /// from1,from4,to1,to4,length, in counts and metres.
    #[arg(long, value_name = "FILE.csv")]
    bars: Option<PathBuf>,
    /// Holes at unknown places, each touched in two working modes or more: a table with the header
    /// hole,counts1,counts4. `hole` is the hole's number.
    #[arg(long, value_name = "FILE.csv")]
    holes: Option<PathBuf>,
    /// A photograph of points that the tip drew: a table with the header counts1,counts4,u,v, in
    /// counts and pixels. May be given again for another photograph.
    #[arg(long, value_name = "FILE.csv")]
    photo: Vec<PathBuf>,
    /// Propose K holes, in the arm's own frame.
    #[arg(
        long,
        value_name = "K",
        value_parser = clap::value_parser!(u16).range(5..=400),
        conflicts_with_all = ["points", "bars", "holes", "photo"],
    )]
    propose: Option<u16>,
    /// Standard deviation of a known hole's x and of its y.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, default_value = "20um")]
    sigma: f64,
    /// Standard deviation of a distance of --bars.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, default_value = "20um")]
    bar_sigma: f64,
    /// Standard deviation of the tip in a hole of --holes, along x and along y.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, default_value = "10um")]
    hole_sigma: f64,
    /// Standard deviation of a point of --photo on the paper, along x and along y.
    #[arg(long, value_name = "LENGTH", value_parser = positive_length, default_value = "50um")]
    photo_sigma: f64,
    /// Minimise the sum of squares in place of Huber's loss.
    #[arg(long, conflicts_with = "propose")]
    plain: bool,
    /// Write the robot file with the measured values to FILE; a file that is there is kept as
    /// FILE.old.
    #[arg(long, value_name = "FILE", conflicts_with = "propose")]
    out: Option<PathBuf>,
    /// Draw the error of the tip over the workspace, as found before and as expected after.
    #[arg(long, value_name = "FILE.svg", conflicts_with = "propose")]
    map: Option<PathBuf>,
    /// Draw the plate with the proposed holes at true size.
    #[arg(
        long,
        value_name = "FILE.svg",
        requires = "propose",
        conflicts_with_all = ["points", "bars", "holes", "photo"],
    )]
    plate: Option<PathBuf>,
    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

const POINTS: [&str; 4] = ["counts1", "counts4", "x", "y"];

impl Args {
    fn criterion(&self) -> Criterion {
        match self.plain {
            true => Criterion::LeastSquares,
            false => Criterion::Huber,
        }
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let robot = Robot::load(&args.robot).map_err(refused)?;
    let several = args.bars.is_some() || args.holes.is_some() || !args.photo.is_empty();
    match (&args.points, args.propose) {
        (Some(points), _) if !several => from_plate(args, &robot, points),
        (_, Some(count)) => proposed(args, &robot, count.into()),
        _ => from_several(args, &robot),
    }
}

fn from_plate(args: &Args, robot: &Robot, points: &Path) -> Result<(), Failure> {
    let rows = read_columns(points, POINTS).map_err(refused)?;
    let in_file = |error| refused(format_args!("{}: {error}", points.display()));
    let study = calibrate_robot(robot, &rows, args.sigma, args.criterion()).map_err(in_file)?;
    for warning in warnings(robot, &study) {
        warn(format_args!("{}: {warning}", points.display()));
    }
    let found = &study.calibration;
    let (rows, far) = (found.residuals.len(), found.rejected.len());
    let kinds = vec![("plate", rows, far, found.residual_rms)];
    let found = Calibrated {
        robot,
        parameters: &found.parameters,
        covariance: &found.covariance,
        placed: true,
        kinds,
        before: study.before.as_ref(),
        after: study.tip_error.as_ref(),
    };
    finish(args, &found, || answer(robot, &study))
}

fn from_several(args: &Args, robot: &Robot) -> Result<(), Failure> {
    let plate = args.points.iter().map(|path| read_columns(path, POINTS));
    let bars = args.bars.iter();
    let bars = bars.map(|path| read_columns(path, ["from1", "from4", "to1", "to4", "length"]));
    let holes = args.holes.iter();
    let holes = holes.map(|path| read_columns(path, ["hole", "counts1", "counts4"]));
    let photos = args.photo.iter();
    let photos = photos.map(|path| read_columns(path, ["counts1", "counts4", "u", "v"]));
    let rows = Rows {
        plate: plate
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?
            .concat(),
        bars: bars
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?
            .concat(),
        holes: holes
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?
            .concat(),
        photos: photos.collect::<Result<_, _>>().map_err(refused)?,
    };
    let deviations = Deviations {
        plate: args.sigma,
        bar: args.bar_sigma,
        hole: args.hole_sigma,
        photo: args.photo_sigma,
    };
    let study =
        calibrate_robot_mixed(robot, &rows, deviations, args.criterion()).map_err(refused)?;
    for warning in mixed_warnings(robot, &study) {
        warn(warning);
    }
    let found = &study.calibration;
    let found = Calibrated {
        robot,
        parameters: &found.parameters,
        covariance: &found.covariance,
        placed: found.placed,
        kinds: found
            .kinds
            .iter()
            .map(|kind| {
                let (rows, far) = (kind.distances.len(), kind.rejected.len());
                (kind.kind.as_str(), rows, far, kind.residual_rms)
            })
            .collect(),
        before: study.before.as_ref(),
        after: study.tip_error.as_ref(),
    };
    finish(args, &found, || mixed_answer(robot, &study))
}

/// Writes what was asked for, and prints the result.
fn finish(
    args: &Args,
    found: &Calibrated<'_>,
    answer: impl FnOnce() -> Value,
) -> Result<(), Failure> {
    draw_map(args, found)?;
    if let Some(out) = &args.out {
        let values = measured(found.robot, found.parameters, found.covariance);
        rewrite(&args.robot, out, &values)?;
    }
    if args.json {
        say(answer())
    } else {
        print(calibration(found))
    }
}

/// Draws the map of --map.
fn draw_map(args: &Args, found: &Calibrated<'_>) -> Result<(), Failure> {
    let Some(path) = &args.map else { return Ok(()) };
    let (Some(before), Some(after)) = (found.before, found.after) else {
        return Err(refused(
            "--map: the arm reaches no place from its home, so there is no map",
        ));
    };
    let robot = found.robot;
    let workspace = robot.workspace(robot.elbows).map_err(refused)?;
    let picture = tip_errors(&robot.name, &workspace.tool, before, after);
    leave_output_to(path);
    write_whole(path, picture.map_err(refused)?).map_err(refused)
}

fn proposed(args: &Args, robot: &Robot, count: usize) -> Result<(), Failure> {
    let study = propose_poses(robot, count, args.sigma).map_err(refused)?;
    if let Some(path) = &args.plate {
        leave_output_to(path);
        write_whole(path, plate(&study.proposal.points)).map_err(refused)?;
    }
    if args.json {
        say(proposal_answer(robot, &study))
    } else {
        print(proposal(&robot.name, &study))
    }
}
