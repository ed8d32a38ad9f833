//! The demonstration, tried on an arm that nobody has seen move yet.

use super::{RunError, Scenario};
use crate::robot::Robot;

/// Sizes at which the demonstration is tried, the largest first: metres in the plane per
/// metre in the job.
const SCALES: [f64; 7] = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01];

/// The greatest of a few scales at which the arm draws the demonstration, by trying.
///
/// # Errors
/// Why it does at none, in a sentence.
pub fn trial(robot: &Robot) -> Result<f64, String> {
    let mut refusal = String::new();
    for scale in SCALES {
        let mut scenario = Scenario::demonstration(robot.clone());
        scenario.scale = scale;
        let job = scenario.job().map_err(|error| error.to_string())?;
        match scenario.check(&job) {
            Ok(()) => {}
            // What is too large here may fit if it is smaller.
            Err(error @ RunError::Target(_)) => {
                refusal = format!("{}, even at a scale of {scale}", scenario.told(&error));
                continue;
            }
            Err(error) => return Err(scenario.told(&error)),
        }
        let (_, record) = scenario
            .simulate(&job, true, &mut |_| ())
            .map_err(|error| scenario.told(&error))?;
        return scenario.stopped_by(&record).map_or(Ok(scale), Err);
    }
    Err(refusal)
}
