//! Studies: the answers of the program's commands, as their JSON.

use crate::error;
use crate::robot::Robot;
use fivebar_design::synthesis::synthesise;
use fivebar_files::design_spec;
use fivebar_files::path_case::PathCase;
use fivebar_report::study::margins::MarginsStudy;
use fivebar_report::study::plan::PlanStudy;
use fivebar_report::study::synthesis;
use fivebar_report::study::workspace::WorkspaceStudy;
use pyo3::prelude::*;
use std::path::Path;

/// The answer of `fivebar workspace`; `resolution` is the side of a cell [m].
#[pyfunction]
pub(crate) fn workspace(
    py: Python<'_>,
    robot: &Robot,
    resolution: Option<f64>,
) -> PyResult<String> {
    let study = py.detach(|| WorkspaceStudy::new(&robot.described, resolution));
    let study = study.map_err(|refusal| error::robot(py, refusal))?;
    Ok(study.answer().to_string())
}

/// The answer of `fivebar margins`.
#[pyfunction]
pub(crate) fn margins(py: Python<'_>, robot: &Robot) -> PyResult<String> {
    let brushed = robot.described.brushed();
    brushed.map_err(|refusal| error::robot(py, refusal))?;
    let study = py.detach(|| MarginsStudy::new(&robot.described));
    let study = study.map_err(|refusal| error::robot(py, refusal))?;
    Ok(study.answer().to_string())
}

/// The answer of `fivebar plan --path`, for a path as its file describes it; `file` is the file's name in errors.
#[pyfunction]
pub(crate) fn plan(
    py: Python<'_>,
    robot: &Robot,
    file: &str,
    text: &str,
    torque_share: f64,
    jerk: Option<f64>,
) -> PyResult<String> {
    let case = PathCase::parse(file, text).map_err(|refusal| error::study(py, refusal))?;
    let study = py.detach(|| PlanStudy::new(&robot.described, &case, torque_share, jerk));
    let study = study.map_err(|refusal| error::study(py, refusal))?;
    Ok(study.answer().to_string())
}

/// The answer of `fivebar design`, and the robot file that it would write. Drawings are looked for in `folder`.
#[pyfunction]
pub(crate) fn design(
    py: Python<'_>,
    file: &str,
    text: &str,
    folder: &str,
    seed: u64,
) -> PyResult<(String, String)> {
    let specification = design_spec::parse(file, text, Path::new(folder));
    let specification = specification.map_err(|refusal| error::study(py, refusal))?;
    let found = py.detach(|| synthesise(&specification, seed, &|_| ()));
    let found = found.map_err(|refusal| error::study(py, refusal))?;
    let stem = Path::new(file).file_stem().unwrap_or_default();
    let robot = synthesis::robot_file(&stem.to_string_lossy(), &found.whole);
    let robot = robot.map_err(|refusal| error::study(py, refusal))?;
    Ok((synthesis::answer(&found).to_string(), robot))
}
