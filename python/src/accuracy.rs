//! The effect of tolerances and clearances: the answers of `fivebar accuracy`, as their JSON.

use crate::error;
use crate::robot::Robot;
use fivebar_design::accuracy::Sampling;
use fivebar_design::accuracy::five_bar::{ToolState, monte_carlo};
use fivebar_files::scenario::Scenario;
use fivebar_report::study::accuracy::{
    accuracy_map, analyse, answer, map_answer, path_accuracy, path_answer,
};
use nalgebra::Vector2;
use pyo3::prelude::*;

/// At one position: position [m], velocity, acceleration of C, and the force on it.
#[pyfunction]
pub(crate) fn accuracy(
    py: Python<'_>,
    robot: &Robot,
    state: [[f64; 2]; 4],
    samples: usize,
    seed: u64,
) -> PyResult<String> {
    let robot = &robot.described;
    let [position, velocity, acceleration, force] = state.map(|[x, y]| Vector2::new(x, y));
    let state = ToolState {
        position,
        velocity,
        acceleration,
        force,
    };
    let analysis = analyse(robot, &state).map_err(|refusal| error::study(py, refusal))?;
    let sampling = Sampling { samples, seed };
    let toleranced = robot.toleranced();
    let sampled = py.detach(|| monte_carlo(&toleranced, &state, &analysis, sampling, &|_| ()));
    Ok(answer(&robot.name, &state, &analysis, &sampled).to_string())
}

/// Over the workspace, or over a rectangle of it [m].
#[pyfunction]
pub(crate) fn accuracy_map_of(
    py: Python<'_>,
    robot: &Robot,
    region: Option<[f64; 4]>,
    force: [f64; 2],
) -> PyResult<String> {
    let robot = &robot.described;
    let map = py.detach(|| accuracy_map(robot, force.into(), region));
    let map = map.map_err(|refusal| error::study(py, refusal))?;
    Ok(map_answer(&robot.name, &map).to_string())
}

/// Along the path of a job, where `fivebar sim` draws it or with its (0, 0) at `origin` [m].
#[pyfunction]
#[allow(
    clippy::too_many_arguments,
    reason = "they are those of the Python function"
)]
pub(crate) fn accuracy_along(
    py: Python<'_>,
    robot: &Robot,
    file: &str,
    text: String,
    origin: Option<[f64; 2]>,
    scale: f64,
    force: [f64; 2],
) -> PyResult<String> {
    let robot = &robot.described;
    let mut scenario = Scenario::new(file, robot.clone(), file, text);
    (scenario.origin, scenario.scale) = (origin, scale);
    let job = scenario.job();
    let job = job.map_err(|refusal| error::scenario(py, refusal))?;
    let along = py.detach(|| path_accuracy(robot, &job, force.into()));
    let along = along.map_err(|refusal| error::study(py, refusal))?;
    Ok(path_answer(&robot.name, &along).to_string())
}
