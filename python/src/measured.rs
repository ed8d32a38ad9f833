//! What measurements tell of an arm: calibration, identification.

use crate::error;
use crate::pool::on_all_cores;
use crate::robot::Robot;
use fivebar_design::calibration::{Criterion, Deviations};
use fivebar_files::robot::{Measured, measured_text};
use fivebar_plant::Mismatch;
use fivebar_report::study::calibration::{
    Rows, answer as calibrated, calibrate_robot, calibrate_robot_mixed, measured as lengths,
    mixed_answer, mixed_warnings, proposal_answer as poses_answer, propose_poses, warnings,
};
use fivebar_report::study::identification::{
    PERIODS, answer as identified, identify_robot, measured as masses, measured_payload,
    payload_answer, payload_of, proposal_answer as excitations_answer, propose_for,
    validation_answer, validations, warning,
};
use fivebar_sim::excitation::excite;
use pyo3::prelude::*;

/// The answer as JSON, the robot file with the measured values, and warnings.
type Found = (String, String, Vec<String>);

/// The robot's file with these values.
fn rewritten(py: Python<'_>, robot: &Robot, values: &[Measured]) -> PyResult<String> {
    measured_text(&robot.file, &robot.text, values).map_err(|refusal| error::file(py, &refusal))
}

/// The answer of `fivebar calibrate`. Standard deviations [m]: of a hole on the plate, of a bar, of a touched hole, of a
/// photographed point.
#[pyfunction]
#[allow(
    clippy::too_many_arguments,
    reason = "they are those of the Python function"
)]
pub(crate) fn calibrate(
    py: Python<'_>,
    robot: &Robot,
    points: Vec<[f64; 4]>,
    bars: Vec<[f64; 5]>,
    holes: Vec<[f64; 3]>,
    photos: Vec<Vec<[f64; 4]>>,
    sigmas: [f64; 4],
    plain: bool,
) -> PyResult<Found> {
    let arm = &robot.described;
    let criterion = match plain {
        true => Criterion::LeastSquares,
        false => Criterion::Huber,
    };
    let refused = |refusal| error::study(py, refusal);
    let [plate, bar, hole, photo] = sigmas;
    if bars.is_empty() && holes.is_empty() && photos.is_empty() {
        let study = on_all_cores(py, || calibrate_robot(arm, &points, plate, criterion))?;
        let study = study.map_err(refused)?;
        let found = &study.calibration;
        let values = lengths(arm, &found.parameters, &found.covariance);
        let text = rewritten(py, robot, &values)?;
        return Ok((
            calibrated(arm, &study).to_string(),
            text,
            warnings(arm, &study),
        ));
    }
    let rows = Rows {
        plate: points,
        bars,
        holes,
        photos,
    };
    let deviations = Deviations {
        plate,
        bar,
        hole,
        photo,
    };
    let study = on_all_cores(py, || {
        calibrate_robot_mixed(arm, &rows, deviations, criterion)
    })?;
    let study = study.map_err(refused)?;
    let found = &study.calibration;
    let values = lengths(arm, &found.parameters, &found.covariance);
    let text = rewritten(py, robot, &values)?;
    Ok((
        mixed_answer(arm, &study).to_string(),
        text,
        mixed_warnings(arm, &study),
    ))
}

/// The answer of `fivebar calibrate --propose`.
#[pyfunction]
pub(crate) fn calibration_poses(
    py: Python<'_>,
    robot: &Robot,
    count: usize,
    sigma: f64,
) -> PyResult<String> {
    let study = on_all_cores(py, || propose_poses(&robot.described, count, sigma))?;
    let study = study.map_err(|refusal| error::study(py, refusal))?;
    Ok(poses_answer(&robot.described, &study).to_string())
}

/// The answer of `fivebar identify --log`, with `--validate` if there is a second log.
#[pyfunction]
pub(crate) fn identify(
    py: Python<'_>,
    robot: &Robot,
    log: Vec<[f64; 5]>,
    second: Option<Vec<[f64; 5]>>,
) -> PyResult<Found> {
    let arm = with_known_torque(py, robot)?;
    let refused = |refusal| error::study(py, refusal);
    let found = on_all_cores(py, || identify_robot(arm, &log))?.map_err(refused)?;
    let mut answer = identified(arm, log.len(), &found);
    if let Some(second) = second {
        let predicted = validations(arm, &found, &second).map_err(refused)?;
        answer["validation"] = validation_answer(predicted);
    }
    let text = rewritten(py, robot, &masses(arm, &found))?;
    let warnings = warning(arm, &found).into_iter().collect();
    Ok((answer.to_string(), text, warnings))
}

/// The answer of `fivebar identify --log --payload`.
#[pyfunction]
pub(crate) fn identify_payload(
    py: Python<'_>,
    robot: &Robot,
    log: Vec<[f64; 5]>,
) -> PyResult<Found> {
    let arm = with_known_torque(py, robot)?;
    let found = on_all_cores(py, || payload_of(arm, &log))?;
    let found = found.map_err(|refusal| error::study(py, refusal))?;
    let text = rewritten(py, robot, &[measured_payload(&found)])?;
    Ok((
        payload_answer(arm, log.len(), &found).to_string(),
        text,
        Vec::new(),
    ))
}

/// The log that `fivebar identify --simulate` writes: rows of time [s], θ1, θ4 [rad], current 1 and 4 [A]; of drives on a CAN
/// bus torque 1 and 4 [N·m].
#[pyfunction]
pub(crate) fn simulated_log(
    py: Python<'_>,
    robot: &Robot,
    second: bool,
) -> PyResult<Vec<[f64; 5]>> {
    let arm = with_known_torque(py, robot)?;
    let rows = on_all_cores(py, || {
        let proposed = propose_for(arm).map_err(|refusal| refusal.to_string())?;
        let excitation = &proposed[usize::from(second)].excitation;
        excite(arm, excitation, PERIODS, &Mismatch::default(), 1)
            .map_err(|refusal| refusal.to_string())
    })?;
    rows.map_err(|refusal| error::study(py, refusal))
}

/// The answer of `fivebar identify --propose`.
#[pyfunction]
pub(crate) fn excitations(py: Python<'_>, robot: &Robot) -> PyResult<String> {
    let arm = with_known_torque(py, robot)?;
    let found = on_all_cores(py, || propose_for(arm))?;
    let found = found.map_err(|refusal| error::study(py, refusal))?;
    Ok(excitations_answer(arm, &found).to_string())
}

fn with_known_torque<'r>(
    py: Python<'_>,
    robot: &'r Robot,
) -> PyResult<&'r fivebar_files::robot::Robot> {
    let known = robot.described.with_known_torque();
    known.map_err(|refusal| error::robot(py, refusal))
}
