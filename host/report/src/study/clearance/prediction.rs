//! The predictions of the models without contact for a job (`docs/design/accuracy.md`).

use crate::study::accuracy::{AccuracyStudyError, path_accuracy};
use fivebar_files::job::Job;
use fivebar_files::robot::Robot;
use nalgebra::Vector2;

/// The greatest values over a job at its feed rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prediction {
    /// Displacement of C in clearance equilibrium: every pin lies where its reaction presses
    /// it [m].
    pub seated: f64,
    /// Exact worst displacement of C over all positions of the pins [m].
    pub worst: f64,
    /// Joint forces by statics and inertia, A to E [N].
    pub reaction: [f64; 5],
}

impl Prediction {
    /// The predictions for a robot with these clearances [m].
    ///
    /// # Errors
    /// As [`path_accuracy`].
    pub fn of(robot: &Robot, job: &Job, clearance: [f64; 5]) -> Result<Self, AccuracyStudyError> {
        let mut worn = robot.clone();
        worn.tolerance.clearance_radius = clearance;
        let along = path_accuracy(&worn, job, Vector2::zeros())?;
        let mut most = Self::default();
        for analysis in along.points.iter().map(|point| &point.analysis) {
            most.worst = most.worst.max(analysis.clearance.worst);
            let Some(forces) = &analysis.forces else {
                continue;
            };
            let equilibrium = &forces.equilibrium;
            most.seated = most.seated.max(equilibrium.displacement.norm());
            for (most, force) in most.reaction.iter_mut().zip(equilibrium.reactions) {
                *most = most.max(force.norm());
            }
        }
        Ok(most)
    }
}
