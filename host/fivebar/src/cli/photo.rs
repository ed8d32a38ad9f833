//! `fivebar photo`: a photograph or a scan of a finished drawing, compared with its job.

use super::failure::{Failure, refused};
use super::length::length;
use super::run_args::JobArgs;
use super::say::{leave_output_to, print, say, warn};
use super::value_error::ValueError;
use clap::ArgGroup;
use fivebar_design::photo::{Lens, Photograph, compare};
use fivebar_files::measurements::read_columns;
use fivebar_files::picture::read_picture;
use fivebar_files::scenario::Scenario;
use fivebar_report::export::{photo_csv, photo_points_csv};
use fivebar_report::output::{OutputFolder, write_whole};
use fivebar_report::picture::drawing_errors;
#[cfg(feature = "png")]
use fivebar_report::picture::png;
use fivebar_report::study::photo::{
    CorrectionError, PhotoStudy, corrected, marks_job, marks_of, measured_places, strokes,
};
use fivebar_report::text;
use nalgebra::Vector2;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Compares a photograph or a scan of a finished drawing with its job: a map of the error in mm.
///
/// Four marks must be on the paper: --draw-marks writes a job that draws them beside the drawing. Then
/// the picture, with the same job, robot and placement, gives photo.svg, the map, and photo.csv. Marks
/// that the arm drew hide what they have in common with the drawing: --distances states where they really
/// are.
#[derive(clap::Args)]
#[command(group = ArgGroup::new("what").args(["draw_marks", "picture"]).required(true))]
pub(super) struct Args {
    #[command(flatten)]
    job: JobArgs,
    /// The photograph or the scan: PNG or JPEG, not cropped.
    #[arg(value_name = "PICTURE.png", requires = "marks")]
    picture: Option<PathBuf>,
    /// Write a job that draws the marks around the drawing. Draw it with --origin 0,0.
    #[arg(long, value_name = "FILE.gcode")]
    draw_marks: Option<PathBuf>,
    /// The job of the marks that were drawn, as --draw-marks wrote it.
    #[arg(long, value_name = "FILE.gcode", requires = "picture")]
    marks: Option<PathBuf>,
    /// Measured distances between the centres of the marks: a table with the header from,to,length, the
    /// numbers of two marks and metres; five or six rows.
    #[arg(long, value_name = "FILE.csv", requires = "picture")]
    distances: Option<PathBuf>,
    /// The distortion k of the lens, with the radius in halves of the picture's diagonal; 0 for a
    /// scanner. By default it is found from the strokes.
    #[arg(long, value_name = "K", value_parser = lens, allow_hyphen_values = true, requires = "picture")]
    lens: Option<f64>,
    /// How far beside its place the ink of a stroke is searched.
    #[arg(long, value_name = "LENGTH", value_parser = window, default_value = "1.5mm")]
    window: f64,
    /// Also write measurements for `calibrate --photo`: the places where strokes of different directions
    /// are near each other.
    #[arg(long, value_name = "FILE.csv", requires = "picture")]
    points: Option<PathBuf>,
    /// Also write the job anew, so much smaller in x and y as the drawing is larger than it: as paper grows. Needs
    /// --distances. Draw it with --origin 0,0.
    #[arg(long, value_name = "FILE.gcode", requires = "distances")]
    corrected: Option<PathBuf>,
    /// The folder for photo.svg and photo.csv; a program built with `--features png` also writes photo.png.
    #[arg(long, value_name = "DIR", default_value = "out/photo")]
    out: PathBuf,
    /// Print the figures as one JSON object.
    #[arg(long)]
    json: bool,
}

fn lens(text: &str) -> Result<f64, ValueError> {
    let lens = text.parse().ok();
    lens.filter(|lens| (-0.12..=0.2).contains(lens))
        .ok_or(ValueError::Lens)
}

/// A length on either side of a stroke [m]: more than the pen is wide, less than drawings are.
fn window(text: &str) -> Result<f64, ValueError> {
    let window = length(text)?;
    match (0.5e-3..=20e-3).contains(&window) {
        true => Ok(window),
        false => Err(ValueError::Window),
    }
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    if !args.job.names_a_job() {
        return Err(Failure::Usage(
            "name the job first, then its picture, as in `fivebar photo my.svg photo.jpg`".into(),
        ));
    }
    let scenario = args.job.scenario()?;
    match (&args.draw_marks, &args.picture, &args.marks) {
        (Some(file), ..) => draw_marks(args, &scenario, file),
        (None, Some(picture), Some(marks)) => measure(args, &scenario, picture, marks),
        // The rules of the arguments exclude it.
        _ => Err(Failure::Usage("give --draw-marks or a picture".into())),
    }
}

fn draw_marks(args: &Args, scenario: &Scenario, file: &Path) -> Result<(), Failure> {
    let (text, marks) = marks_job(scenario).map_err(refused)?;
    leave_output_to(file);
    write_whole(file, text).map_err(refused)?;
    if args.json {
        return say(json!({ "marks_m": marks.map(|mark| [mark.x, mark.y]) }));
    }
    for (index, mark) in marks.iter().enumerate() {
        say(format_args!(
            "mark {} at ({:.1}, {:.1}) mm",
            index + 1,
            1e3 * mark.x,
            1e3 * mark.y
        ))?;
    }
    say(format_args!(
        "wrote {}; draw it on the same paper with --origin 0,0, without homing in between",
        file.display()
    ))
}

fn measure(
    args: &Args,
    scenario: &Scenario,
    picture_file: &Path,
    marks_file: &Path,
) -> Result<(), Failure> {
    if args.points.is_some() && scenario.robot.tool.offset != [0.0; 2] {
        return Err(refused(format_args!(
            "--points needs a pen at C: `calibrate` measures C, and the pen of `{}` is beside it ([tool] offset)",
            scenario.robot.name
        )));
    }
    let folder = OutputFolder::prepare(&args.out, "--out").map_err(refused)?;
    let in_marks =
        |error: &dyn std::fmt::Display| refused(format_args!("{}: {error}", marks_file.display()));
    let text = fivebar_files::job::read(marks_file).map_err(|error| in_marks(&error))?;
    let drawn = marks_of(&text).map_err(|error| in_marks(&error))?;
    let measured = args.distances.as_ref();
    let measured = measured.map(|file| measured_in(drawn, file)).transpose()?;
    let picture = read_picture(picture_file).map_err(refused)?;
    let job = scenario.job().map_err(refused)?;
    let start = scenario.home_point().unwrap_or_default().map(f64::from);
    let strokes = strokes(&job, start);
    let comparison = compare(&Photograph {
        picture: &picture,
        strokes: &strokes.points,
        marks: drawn,
        measured,
        lens: args.lens.map_or(Lens::Unknown, Lens::Known),
        window: args.window,
    });
    let comparison =
        comparison.map_err(|error| refused(format_args!("{}: {error}", picture_file.display())))?;
    let study = PhotoStudy {
        strokes,
        marks: measured.unwrap_or(drawn),
        comparison,
    };
    write(args, scenario, &folder, &study)?;
    if let Some(file) = &args.corrected {
        let scales = study.comparison.scales;
        let scales = scales.ok_or(CorrectionError::NoScales).map_err(refused)?;
        let text = corrected(&job, start, scales.factors).map_err(refused)?;
        leave_output_to(file);
        write_whole(file, text).map_err(refused)?;
    }
    if args.json {
        let picture = picture_file.display().to_string();
        let mut answer = study.answer(&scenario.job_file, &picture, &scenario.robot.name);
        answer["out_dir"] = folder.path().display().to_string().into();
        return say(answer);
    }
    print(text::photo(&study, measured.is_some(), args.lens.is_some()))?;
    say(format_args!(
        "wrote {}",
        folder.path().join("photo.{svg,csv}").display()
    ))
}

/// Writes the map, the table and the points for a calibration.
fn write(
    args: &Args,
    scenario: &Scenario,
    folder: &OutputFolder,
    study: &PhotoStudy,
) -> Result<(), Failure> {
    let name = Path::new(&scenario.job_file).file_name();
    let name = name.map_or(scenario.job_file.as_str().into(), |name| {
        name.to_string_lossy()
    });
    let map = drawing_errors(&name, study);
    let table = photo_csv(study);
    #[cfg(feature = "png")]
    let image = png(&map).map_err(refused)?;
    let files: &[(&str, &dyn AsRef<[u8]>)] = &[
        ("photo.svg", &map),
        #[cfg(feature = "png")]
        ("photo.png", &image),
        ("photo.csv", &table),
    ];
    folder.write(files).map_err(refused)?;
    let Some(points) = &args.points else {
        return Ok(());
    };
    let rows = study.calibration_rows(&scenario.robot).map_err(refused)?;
    if rows.len() < 5 {
        warn(format_args!(
            "{} has {} points, and a calibration needs five poses at least: draw a job with more \
             strokes that cross or turn",
            points.display(),
            rows.len()
        ));
    }
    leave_output_to(points);
    write_whole(points, photo_points_csv(&rows)).map_err(refused)
}

/// The marks with the distances in a table.
fn measured_in(drawn: [Vector2<f64>; 4], file: &Path) -> Result<[Vector2<f64>; 4], Failure> {
    let rows = read_columns(file, ["from", "to", "length"]).map_err(refused)?;
    measured_places(drawn, &rows)
        .map_err(|error| refused(format_args!("{}: {error}", file.display())))
}
