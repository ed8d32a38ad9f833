//! Studies: the answers of the program's commands, as their JSON.

use crate::error;
use crate::pool::on_all_cores;
use crate::robot::Robot;
use crate::simulation::Scenario;
use fivebar_files::path_case::PathCase;
use fivebar_report::study::clearance as clearance_study;
use fivebar_report::study::crossing::{self as crossing_study, CrossingStudyError};
use fivebar_report::study::margins::MarginsStudy;
use fivebar_report::study::plan::PlanStudy;
use fivebar_report::study::workspace::WorkspaceStudy;
use fivebar_sim::crossing::{CrossingConditions, follow};
use fivebar_sim::simulation::Simulate;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

/// The answer of `fivebar workspace`; `resolution` is the side of a cell [m].
#[pyfunction]
pub(crate) fn workspace(
    py: Python<'_>,
    robot: &Robot,
    resolution: Option<f64>,
) -> PyResult<String> {
    let study = on_all_cores(py, || WorkspaceStudy::new(&robot.described, resolution))?;
    let study = study.map_err(|refusal| error::robot(py, refusal))?;
    Ok(study.answer().to_string())
}

/// The answer of `fivebar margins`.
#[pyfunction]
pub(crate) fn margins(py: Python<'_>, robot: &Robot) -> PyResult<String> {
    let known = robot.described.with_known_torque();
    known.map_err(|refusal| error::robot(py, refusal))?;
    let study = on_all_cores(py, || MarginsStudy::new(&robot.described))?;
    let study = study.map_err(|refusal| error::robot(py, refusal))?;
    Ok(study.answer().to_string())
}

/// A plan along a path.
#[pyclass(frozen, module = "fivebar._native")]
pub(crate) struct Plan {
    study: PlanStudy,
}

#[pymethods]
impl Plan {
    /// Along a path as its file describes it; `file` is the file's name in errors.
    #[new]
    fn new(
        py: Python<'_>,
        robot: &Robot,
        file: &str,
        text: &str,
        torque_share: f64,
        jerk: Option<f64>,
    ) -> PyResult<Self> {
        let case = PathCase::parse(file, text).map_err(|refusal| error::study(py, refusal))?;
        let study = on_all_cores(py, || {
            PlanStudy::new(&robot.described, &case, torque_share, jerk)
        })?;
        let study = study.map_err(|refusal| error::study(py, refusal))?;
        Ok(Self { study })
    }

    /// The answer of `fivebar plan --path`.
    fn answer(&self) -> String {
        self.study.answer().to_string()
    }

    /// At these times [s], a row of fourteen numbers for each, flat: θ, ω, α, the tool with its velocity and acceleration,
    /// and τ, NaN for a robot without masses.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        times: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut numbers = Vec::new();
        for &time in times.as_slice()? {
            let at = self
                .study
                .at(time)
                .map_err(|refusal| error::pose(py, refusal))?;
            let vectors = [at.tool, at.velocity, at.acceleration].map(Into::into);
            let torque = at.torque.unwrap_or([f64::NAN; 2]);
            let pairs: [[f64; 2]; 3] = vectors;
            let joints = [at.theta, at.omega, at.alpha].into_iter();
            numbers.extend(joints.chain(pairs).chain([torque]).flatten());
        }
        Ok(numbers.into_pyarray(py))
    }
}

/// The answer of `fivebar plan --crossing`, with a simulated run where one is wanted.
#[pyfunction]
pub(crate) fn crossing(
    py: Python<'_>,
    robot: &Robot,
    ends: [[f64; 2]; 2],
    time: f64,
    simulate: bool,
) -> PyResult<String> {
    let robot = &robot.described;
    let refused = |refusal: CrossingStudyError| error::study(py, refusal);
    let task = crossing_study::task(robot, ends, time).map_err(refused)?;
    let plan = on_all_cores(py, || task.plan())?;
    let plan = plan.map_err(|refusal| error::study(py, refusal))?;
    let controller = crossing_study::check_by_controller(robot, &task, &plan);
    let run = simulate.then(|| {
        let run = on_all_cores(py, || {
            follow(robot, &task, &plan, &CrossingConditions::default())
        })?;
        run.map_err(|refusal| error::study(py, refusal))
    });
    let answer = crossing_study::answer(&plan, &controller, run.transpose()?.as_ref());
    Ok(answer.to_string())
}

/// The answer of `fivebar clearance`: a job with each of these clearances of the joints A to E [m].
#[pyfunction]
pub(crate) fn clearance(
    py: Python<'_>,
    scenario: &Scenario,
    clearances: Vec<[f64; 5]>,
    origin: Option<[f64; 2]>,
    scale: Option<f64>,
) -> PyResult<String> {
    let mut scenario = scenario.described.clone();
    scenario.origin = origin.or(scenario.origin);
    scenario.scale = scale.unwrap_or(scenario.scale);
    let job = scenario.job();
    let job = job.map_err(|refusal| error::scenario(py, refusal))?;
    scenario
        .check(&job)
        .map_err(|refusal| error::run(py, &scenario.job_file, refusal))?;
    let found = on_all_cores(py, || {
        clearance_study::study(&scenario, &job, &clearances, &|| ())
    })?;
    let found = found.map_err(|refusal| error::study(py, refusal))?;
    Ok(clearance_study::answer(&found).to_string())
}
