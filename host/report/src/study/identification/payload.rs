//! The payload of a robot alone.

use super::{StudyError, log_of, observed};
use fivebar_design::identification::{Payload, identify_payload};
use fivebar_files::robot::{Measured, MeasuredKey, Robot};

/// Finds the payload of a robot with known masses from rows of time, θ1, θ4, current 1, current 4.
///
/// # Errors
/// The robot has no masses, actuators or pose at home, or the log is refused.
pub fn payload_of(robot: &Robot, rows: &[[f64; 5]]) -> Result<Payload, StudyError> {
    let found = identify_payload(&log_of(robot, rows)?, &observed(robot)?, robot.arm()?)?;
    Ok(found)
}

/// The payload of the robot file.
pub fn measured_payload(found: &Payload) -> Measured {
    Measured {
        key: MeasuredKey::Payload,
        value: format!("{:.6}", found.mass.max(0.0)),
        origin: format!("± {:.2} g by identification", 1e3 * found.sd),
    }
}
