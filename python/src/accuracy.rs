//! The effect of tolerances and clearances: the answers of `fivebar accuracy`, as their JSON.

use crate::error;
use crate::pool::on_all_cores;
use crate::robot::Robot;
use fivebar_design::accuracy::Sampling;
use fivebar_design::accuracy::five_bar::{MonteCarlo, ToolState, monte_carlo};
use fivebar_design::accuracy::slider::sample_slider;
use fivebar_files::accuracy_classes::Classes;
use fivebar_files::linkage::DrivenLinkage;
use fivebar_files::robot::Mechanism;
use fivebar_files::scenario::Scenario;
use fivebar_report::study::accuracy::{
    AccuracyStudyError, accuracy_map, allocation_answer, analyse, analyse_slider, answer, cheapest,
    linkage_answer, map_answer, path_accuracy, path_answer, slider_answer, study_linkage,
};
use nalgebra::Vector2;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::Path;

/// At one position: position [m], velocity, acceleration of C, and the force on it. `parts` has the sums of all blocks of
/// the samples, in their order; without it they are drawn here.
#[pyfunction]
pub(crate) fn accuracy(
    py: Python<'_>,
    robot: &Robot,
    state: [[f64; 2]; 4],
    samples: usize,
    seed: u64,
    parts: Option<Vec<PyReadonlyArray1<'_, f64>>>,
) -> PyResult<String> {
    let robot = &robot.described;
    let state = tool_state(state);
    let analysis = analyse(robot, &state).map_err(|refusal| error::study(py, refusal))?;
    let sampling = Sampling { samples, seed };
    let toleranced = robot.toleranced();
    let sampled = match parts {
        None => on_all_cores(py, || {
            monte_carlo(&toleranced, &state, &analysis, sampling, &|_| ())
        })?,
        Some(parts) => {
            let slices: Vec<&[f64]> = parts
                .iter()
                .map(|part| Ok(part.as_slice()?))
                .collect::<PyResult<_>>()?;
            let mut numbers = slices.into_iter().flatten().copied();
            let block =
                |_| MonteCarlo::from_numbers(&toleranced, &analysis, sampling, &mut numbers);
            let blocks: Option<Vec<_>> = (0..sampling.blocks()).map(block).collect();
            let blocks = blocks.ok_or_else(|| PyValueError::new_err("parts are missing"))?;
            MonteCarlo::merged(&analysis, sampling, &blocks)
        }
    };
    Ok(answer(&robot.name, &state, &analysis, &sampled).to_string())
}

/// The number of blocks of so many samples.
#[pyfunction]
pub(crate) fn accuracy_blocks(samples: usize) -> usize {
    Sampling { samples, seed: 0 }.blocks()
}

/// The sums of some blocks of the samples, on this thread.
#[pyfunction]
pub(crate) fn accuracy_part<'py>(
    py: Python<'py>,
    robot: &Robot,
    state: [[f64; 2]; 4],
    samples: usize,
    seed: u64,
    blocks: [usize; 2],
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let robot = &robot.described;
    let state = tool_state(state);
    let analysis = analyse(robot, &state).map_err(|refusal| error::study(py, refusal))?;
    let sampling = Sampling { samples, seed };
    let toleranced = robot.toleranced();
    let [first, end] = blocks;
    let numbers: Vec<f64> = on_all_cores(py, || {
        let block =
            |block| MonteCarlo::block(&toleranced, &state, &analysis, sampling, block, &|_| ());
        let blocks = first..end.min(sampling.blocks());
        blocks.flat_map(|index| block(index).to_numbers()).collect()
    })?;
    Ok(numbers.into_pyarray(py))
}

fn tool_state(state: [[f64; 2]; 4]) -> ToolState {
    let [position, velocity, acceleration, force] = state.map(|[x, y]| Vector2::new(x, y));
    ToolState {
        position,
        velocity,
        acceleration,
        force,
    }
}

/// Over the workspace, or over a rectangle of it [m].
#[pyfunction]
pub(crate) fn accuracy_map_of(
    py: Python<'_>,
    robot: &Robot,
    region: Option<[f64; 4]>,
    force: [f64; 2],
    wanted: Option<(f64, String)>,
) -> PyResult<String> {
    let robot = &robot.described;
    let map = on_all_cores(py, || accuracy_map(robot, force.into(), region))?;
    let map = map.map_err(|refusal| error::study(py, refusal))?;
    let mut answer = map_answer(&robot.name, &map);
    if let Some((deviation, classes)) = wanted {
        let classes = Classes::read(Path::new(&classes));
        let classes = classes.map_err(|refusal| error::study(py, refusal))?;
        let cheapest = on_all_cores(py, || cheapest(&map, deviation, &classes))?;
        let cheapest = cheapest.map_err(|refusal| error::study(py, refusal))?;
        answer["allocation"] = allocation_answer(&cheapest);
    }
    Ok(answer.to_string())
}

/// Of a linkage at an instant [s], for an example's name or a file.
#[pyfunction]
pub(crate) fn linkage_accuracy(
    py: Python<'_>,
    file: &str,
    time: f64,
    samples: usize,
    seed: u64,
) -> PyResult<String> {
    let driven = DrivenLinkage::load(file).map_err(|refusal| error::study(py, refusal))?;
    let sampling = Sampling { samples, seed };
    let found = on_all_cores(py, || study_linkage(&driven, time, sampling, &|_| ()))?;
    let found = found.map_err(|refusal| error::study(py, refusal))?;
    Ok(linkage_answer(&driven, &found).to_string())
}

/// Of a slider-driven mechanism with P at a point [m] and a force on it [N], for a built-in one's name or a file.
#[pyfunction]
pub(crate) fn slider_accuracy(
    py: Python<'_>,
    file: &str,
    at: [f64; 2],
    force: [f64; 2],
    samples: usize,
    seed: u64,
) -> PyResult<String> {
    let mechanism = Mechanism::load(file).map_err(|refusal| error::file(py, &refusal))?;
    let Mechanism::Slider(robot) = mechanism else {
        let reason = format!("{file} is an arm with four links: ask Arm.accuracy");
        return Err(error::study(py, reason));
    };
    let found = on_all_cores(py, || {
        let analysis = analyse_slider(&robot, at.into(), force.into())?;
        let sampling = Sampling { samples, seed };
        let sampled = sample_slider(&robot.toleranced(), &analysis, sampling, &|_| ());
        Ok(slider_answer(&robot, &analysis, &sampled))
    })?;
    let found = found.map_err(|refusal: AccuracyStudyError| error::study(py, refusal))?;
    Ok(found.to_string())
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
    let along = on_all_cores(py, || path_accuracy(robot, &job, force.into()))?;
    let along = along.map_err(|refusal| error::study(py, refusal))?;
    Ok(path_answer(&robot.name, &along).to_string())
}
