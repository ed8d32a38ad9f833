//! The demonstration, tried on an arm that nobody has seen move yet.

use super::{Record, RunError};
use crate::input::robot::Robot;
use crate::input::scenario::{Scenario, ScenarioError};

/// Sizes at which the demonstration is tried, the largest first: metres in the plane per
/// metre in the job.
const SCALES: [f64; 7] = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];

/// Why an arm does not draw the demonstration, with what was tried.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The robot or the job makes no sense.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The job cannot be done, the least of the sizes neither.
    #[error("{1}, even at a scale of {scale}", scale = .0.scale)]
    TooLarge(Box<Scenario>, RunError),
    /// The run was refused or broken off.
    #[error("{1}")]
    Run(Box<Scenario>, RunError),
    /// A fault stopped the arm.
    #[error("a fault stopped the arm")]
    Stopped(Box<Scenario>, Box<Record>),
}

/// The greatest of a few scales at which the arm draws the demonstration, by trying.
///
/// # Errors
/// Why it does at none.
pub fn trial(robot: &Robot) -> Result<f64, TrialError> {
    let mut scenario = Box::new(Scenario::demonstration(robot.clone()));
    let mut refusal = None;
    for scale in SCALES {
        scenario.scale = scale;
        let job = scenario.job()?;
        match scenario.check(&job) {
            Ok(()) => {}
            // What is too large here may fit if it is smaller.
            Err(error @ RunError::Target(_)) => {
                refusal = Some(error);
                continue;
            }
            Err(error) => return Err(TrialError::Run(scenario, error)),
        }
        return match scenario.simulate(&job, true, &mut |_| ()) {
            Ok((_, record)) if record.faults.is_empty() => Ok(scale),
            Ok((_, record)) => Err(TrialError::Stopped(scenario, Box::new(record))),
            Err(error) => Err(TrialError::Run(scenario, error)),
        };
    }
    Err(TrialError::TooLarge(
        scenario,
        refusal.expect("a scale is tried"),
    ))
}
