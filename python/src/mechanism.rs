//! Mechanisms beyond the five-bar arm, and the arm for other tools.

use crate::error;
use crate::pool::on_all_cores;
use crate::robot::Robot;
use fivebar_files::linkage::DrivenLinkage;
use fivebar_files::mobility::{EXAMPLES, parse};
use fivebar_report::export::{dot, mjcf, urdf};
use fivebar_report::study::linkage::summary;
use fivebar_report::study::mobility::{analyse, answer};
use pyo3::prelude::*;

/// The answer of `fivebar linkage`, for an example's name, or for a text whose file has the name `file`.
#[pyfunction]
pub(crate) fn linkage(py: Python<'_>, file: &str, text: Option<&str>) -> PyResult<String> {
    let driven = match text {
        Some(text) => DrivenLinkage::parse(file, text),
        None => DrivenLinkage::load(file),
    };
    let driven = driven.map_err(|refusal| error::study(py, refusal))?;
    let summary = on_all_cores(py, || summary(&driven, &driven.sweep()))?;
    Ok(serde_json::json!(summary).to_string())
}

/// The answers of `fivebar mobility`, one for each mechanism, for an example's name or a text.
#[pyfunction]
pub(crate) fn mobility(py: Python<'_>, file: &str, text: &str) -> PyResult<Vec<String>> {
    let example = EXAMPLES.iter().find(|(name, _)| *name == text);
    let cases = match example {
        Some((name, text)) => parse(&format!("example {name}"), text),
        None => parse(file, text),
    };
    let cases = cases.map_err(|refusal| error::study(py, refusal))?;
    let answers = on_all_cores(py, || {
        let answers = cases.iter().map(|case| answer(&case.name, &analyse(case)));
        answers.map(|answer| answer.to_string()).collect()
    })?;
    Ok(answers)
}

/// The text of `fivebar export`.
#[pyfunction]
pub(crate) fn export(py: Python<'_>, robot: &Robot, format: &str) -> PyResult<Option<String>> {
    let robot = &robot.described;
    let text = match format {
        "mjcf" => mjcf(robot),
        "urdf" => urdf(robot),
        "dot" => return Ok(Some(dot(robot))),
        _ => return Ok(None),
    };
    let text = text.map_err(|refusal| error::robot(py, refusal))?;
    Ok(Some(text))
}
