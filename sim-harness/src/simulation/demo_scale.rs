//! The scale at which a new arm can draw the demonstration.

use super::{Record, RunError, Simulate};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::{Scenario, ScenarioError};

/// The scales that are tried, the largest first: metres in the plane per metre in the job.
const SCALES: [f64; 7] = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];

/// Why an arm cannot draw the demonstration, with the scenario that was tried.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DemoScaleError {
    /// The robot or the job is not valid.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The job cannot be done, even at the least scale.
    #[error("{1}, even at a scale of {scale}", scale = .0.scale)]
    TooLarge(Box<Scenario>, RunError),
    /// The run was refused or ended early.
    #[error("{1}")]
    Run(Box<Scenario>, RunError),
    /// A fault stopped the arm.
    #[error("a fault stopped the arm")]
    Stopped(Box<Scenario>, Box<Record>),
    /// The arm drew it wrong.
    #[error("{0}")]
    NotDrawn(String),
}

/// See [`Simulate::fit`].
pub(super) fn fit(scenario: &mut Scenario) -> Result<(), RunError> {
    let mut refused = Ok(());
    for scale in SCALES {
        scenario.scale = scale;
        match scenario.check(&scenario.job()?) {
            // A job that is too large may fit at a smaller scale.
            Err(error @ RunError::Target(_)) => refused = Err(error),
            other => return other,
        }
    }
    refused
}

/// The greatest of a few scales at which the controller accepts the demonstration, if the
/// arm draws it at this scale in simulation, without a fault and within the tolerance.
///
/// # Errors
/// The reason if it does so at no scale.
pub fn find_demo_scale(robot: &Robot) -> Result<f64, DemoScaleError> {
    let mut scenario = Box::new(Scenario::demonstration(robot.clone()));
    match scenario.fit() {
        Ok(()) => {}
        Err(RunError::Scenario(error)) => return Err(DemoScaleError::Scenario(error)),
        Err(error @ RunError::Target(_)) => return Err(DemoScaleError::TooLarge(scenario, error)),
        Err(error) => return Err(DemoScaleError::Run(scenario, error)),
    }
    let job = scenario.job()?;
    match scenario.simulate(&job, &mut |_| ()) {
        Ok((_, record)) if !record.faults.is_empty() => {
            Err(DemoScaleError::Stopped(scenario, Box::new(record)))
        }
        Ok((summary, _)) => match summary.verdict.why {
            None => Ok(scenario.scale),
            Some(why) => Err(DemoScaleError::NotDrawn(why)),
        },
        Err(error) => Err(DemoScaleError::Run(scenario, error)),
    }
}
