//! The same run with each mismatch alone.

use super::{RunError, Simulate, Summary, TipError};
use fivebar_files::job::Job;
use fivebar_files::scenario::Scenario;
use fivebar_plant::Mismatch;
use rayon::prelude::*;
use serde::Serialize;

/// The error of a run under one mismatch alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CauseError {
    /// Its key under `[mismatch]`, or "none" or "all".
    pub cause: String,
    /// The tip error of the run, up to its first fault.
    pub tip_error: TipError,
    /// The faults of the run, by name.
    pub faults: Vec<String>,
}

/// See [`Simulate::by_cause`].
pub(super) fn by_cause(
    scenario: &Scenario,
    job: &Job,
    all: &Summary,
) -> Result<Vec<CauseError>, RunError> {
    let mut runs = vec![("none", Mismatch::NONE)];
    runs.extend(scenario.mismatch.alone());
    let alone: Result<Vec<CauseError>, RunError> = runs
        .into_par_iter()
        .map(|(cause, mismatch)| {
            let alone = Scenario {
                mismatch,
                ..scenario.clone()
            };
            let (summary, _) = alone.simulate(job, &mut |_| ())?;
            Ok(CauseError::new(cause, &summary))
        })
        .collect();
    let mut errors = alone?;
    errors.push(CauseError::new("all", all));
    Ok(errors)
}
impl CauseError {
    fn new(cause: &str, summary: &Summary) -> Self {
        Self {
            cause: cause.into(),
            tip_error: summary.tip_error,
            faults: summary.faults.clone(),
        }
    }
}
