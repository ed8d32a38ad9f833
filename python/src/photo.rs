//! A photograph of a drawing, compared with its job: the answers of `fivebar photo`.

use crate::error;
use crate::pool::on_all_cores;
use crate::robot::Robot;
use fivebar_design::photo::{Lens, Photograph, compare};
use fivebar_files::picture::read_picture;
use fivebar_files::scenario::Scenario;
use fivebar_report::study::photo::{PhotoStudy, marks_job, marks_of, measured_places, strokes};
use pyo3::prelude::*;
use serde_json::json;
use std::path::Path;

/// A job's file and text, the position of its (0, 0) [m], its scale and its turn [rad].
type Placed = (String, String, Option<[f64; 2]>, f64, f64);

fn scenario(robot: &Robot, (file, text, origin, scale, turn): Placed) -> Scenario {
    Scenario {
        origin,
        scale,
        turn,
        ..Scenario::new(&file, robot.described.clone(), &file, text)
    }
}

/// The job that draws the marks, and the answer with their places.
#[pyfunction]
pub(crate) fn photo_marks(
    py: Python<'_>,
    robot: &Robot,
    job: Placed,
) -> PyResult<(String, String)> {
    let scenario = scenario(robot, job);
    let found = on_all_cores(py, || marks_job(&scenario))?;
    let (text, marks) = found.map_err(|refusal| error::study(py, refusal))?;
    let marks = json!({ "marks_m": marks.map(|mark| [mark.x, mark.y]) });
    Ok((text, marks.to_string()))
}

/// The answer for a picture, and the points for a calibration: none where the pen is beside C or the arm has no counts.
#[pyfunction]
#[allow(
    clippy::too_many_arguments,
    reason = "they are those of the Python function"
)]
pub(crate) fn photo(
    py: Python<'_>,
    robot: &Robot,
    job: Placed,
    picture: &str,
    marks: &str,
    distances: Option<Vec<[f64; 3]>>,
    lens: Option<f64>,
    window: f64,
) -> PyResult<(String, Vec<[f64; 4]>)> {
    let scenario = scenario(robot, job);
    let drawn = marks_of(marks).map_err(|refusal| error::study(py, refusal))?;
    let measured = distances.map(|rows| measured_places(drawn, &rows));
    let measured = measured.transpose();
    let measured = measured.map_err(|refusal| error::study(py, refusal))?;
    let image = py.detach(|| read_picture(Path::new(picture)));
    let image = image.map_err(|refusal| error::study(py, refusal))?;
    let job = scenario.job();
    let job = job.map_err(|refusal| error::scenario(py, refusal))?;
    let start = scenario.home_point().unwrap_or_default().map(f64::from);
    let strokes = strokes(&job, start);
    let comparison = on_all_cores(py, || {
        compare(&Photograph {
            picture: &image,
            strokes: &strokes.points,
            marks: drawn,
            measured,
            lens: lens.map_or(Lens::Unknown, Lens::Known),
            window,
        })
    })?;
    let study = PhotoStudy {
        strokes,
        marks: measured.unwrap_or(drawn),
        comparison: comparison.map_err(|refusal| error::study(py, refusal))?,
    };
    let robot = &scenario.robot;
    let is_at_c = robot.tool.offset == [0.0; 2];
    let points = is_at_c
        .then(|| study.calibration_rows(robot).ok())
        .flatten();
    let answer = study.answer(&scenario.job_file, picture, &robot.name);
    Ok((answer.to_string(), points.unwrap_or_default()))
}
