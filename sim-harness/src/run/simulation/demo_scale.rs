//! The demonstration, tried on an arm that nobody has seen move yet.

use super::{Record, RunError};
use crate::input::robot::Robot;
use crate::input::scenario::{Scenario, ScenarioError};

/// Sizes at which a job is tried, the largest first: metres in the plane per metre in the
/// job.
const SCALES: [f64; 7] = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];

/// Why an arm does not draw the demonstration, with what was tried.
#[derive(Debug, thiserror::Error)]
pub enum DemoScaleError {
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

impl Scenario {
    /// Makes the job as large as the arm has room for: of a few scales the greatest at which
    /// the controller takes it.
    ///
    /// # Errors
    /// The refusal at the smallest scale, or what else keeps the job from being run.
    pub fn fit(&mut self) -> Result<(), RunError> {
        let mut refused = Ok(());
        for scale in SCALES {
            self.scale = scale;
            match self.check(&self.job()?) {
                // What is too large here may fit if it is smaller.
                Err(error @ RunError::Target(_)) => refused = Err(error),
                other => return other,
            }
        }
        refused
    }
}

/// The greatest of a few scales at which the arm draws the demonstration, by trying.
///
/// # Errors
/// Why it does at none.
pub fn find_demo_scale(robot: &Robot) -> Result<f64, DemoScaleError> {
    let mut scenario = Box::new(Scenario::demonstration(robot.clone()));
    match scenario.fit() {
        Ok(()) => {}
        Err(RunError::Scenario(error)) => return Err(DemoScaleError::Scenario(error)),
        Err(error @ RunError::Target(_)) => return Err(DemoScaleError::TooLarge(scenario, error)),
        Err(error) => return Err(DemoScaleError::Run(scenario, error)),
    }
    let job = scenario.job()?;
    match scenario.simulate(&job, true, &mut |_| ()) {
        Ok((_, record)) if record.faults.is_empty() => Ok(scenario.scale),
        Ok((_, record)) => Err(DemoScaleError::Stopped(scenario, Box::new(record))),
        Err(error) => Err(DemoScaleError::Run(scenario, error)),
    }
}
