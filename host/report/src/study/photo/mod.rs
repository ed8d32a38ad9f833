//! A photograph of a finished drawing, compared with its job.

mod corrected;
mod marks;
mod strokes;

pub use corrected::{CorrectionError, corrected};
pub use marks::{MarksError, marks_job, marks_of, measured_places};
pub use strokes::{JobStrokes, strokes};

use super::calibration::{StudyError, encoder_count};
use fivebar_design::photo::{Comparison, PhotoError, local_points};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::ScenarioError;
use nalgebra::Vector2;
use serde_json::{Value, json};

/// A drawing compared with its job.
#[derive(Debug)]
pub struct PhotoStudy {
    /// The strokes of the job.
    pub strokes: JobStrokes,
    /// The marks on the paper [m].
    pub marks: [Vector2<f64>; 4],
    /// The result.
    pub comparison: Comparison,
}

/// Why a photograph cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PhotoStudyError {
    /// The job cannot be read.
    #[error(transparent)]
    Job(#[from] ScenarioError),
    /// The marks' job.
    #[error(transparent)]
    Marks(#[from] MarksError),
    /// The picture.
    #[error(transparent)]
    Photo(#[from] PhotoError),
    /// The robot has no counts or no pose.
    #[error(transparent)]
    Robot(#[from] StudyError),
}

impl PhotoStudy {
    /// The line of the job, or the stroke of a drawing, of the greatest error, with the error and the
    /// place [m].
    pub fn greatest(&self) -> Option<(u32, f64, Vector2<f64>)> {
        let greatest = self.comparison.greatest()?;
        let line = self.strokes.line(greatest.stroke, greatest.piece);
        Some((line, greatest.error, greatest.place))
    }

    /// The figures as JSON, with the names of the job, the picture and the robot.
    pub fn answer(&self, job: &str, picture: &str, robot: &str) -> Value {
        let found = &self.comparison;
        let greatest = self.greatest().map(|(line, error, place)| {
            json!({ "error_m": error, "at_m": [place.x, place.y], "line": line })
        });
        json!({
            "job": job,
            "picture": picture,
            "robot": robot,
            "rms_m": found.rms,
            "greatest": greatest,
            "points": found.deviations.len(),
            "drawn_m": found.drawn,
            "measured_m": found.measured,
            "pixel_m": found.pixel,
            "lens": found.lens,
            "lens_shift_m": found.lens_shift,
            "scales": found.scales.map(|scales| json!({
                "factors": scales.factors,
                "deviations": scales.deviations,
            })),
            "marks_m": self.marks.map(|mark| [mark.x, mark.y]),
        })
    }

    /// The points that are known in both directions, as rows of counts1, counts4, u, v for `calibrate
    /// --photo`: the counts as the robot's file has them at the point, and pixels of a lens without
    /// distortion.
    ///
    /// # Errors
    /// The robot has no counts or no pose at home.
    pub fn calibration_rows(&self, robot: &Robot) -> Result<Vec<[f64; 4]>, PhotoStudyError> {
        let home = robot.home_pose().map_err(StudyError::from)?;
        let tool = robot.tool_on_link().map_err(StudyError::from)?;
        let mut rows = Vec::new();
        for point in local_points(&self.comparison) {
            let Ok(pose) = tool.inverse(point.place, home.working_mode()) else {
                continue;
            };
            let [theta1, _, _, theta4] = pose.angles();
            let [counts1, counts4] = encoder_count(robot, [theta1, theta4])?;
            rows.push([counts1, counts4, point.pixel.x, point.pixel.y]);
        }
        Ok(rows)
    }
}
