//! A job that is drawn smaller by what a photograph shows the drawing to be larger, in x and in y.

use super::strokes::points_of;
use fivebar_files::job::{Action, Job};
use nalgebra::Vector2;
use std::fmt::Write as _;

/// Why a job cannot be corrected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CorrectionError {
    /// The picture does not show the scales.
    #[error(
        "the scales are not known: measure the marks' distances (--distances), on a drawing with strokes in all directions"
    )]
    NoScales,
    /// The job changes the power of its tool.
    #[error(
        "line {0} of the job has a power between off and full, and only a pen's job is corrected"
    )]
    Power(u32),
    /// The job changes the mode of the arm.
    #[error(
        "line {0} of the job changes the working or the assembly mode, and such a job is not corrected"
    )]
    Mode(u32),
}

/// The job as G-code in the frame of the base, its points moved towards their middle so that a drawing that becomes `factors`
/// times as large in x and y is right. Arcs become lines within 5 µm.
///
/// # Errors
/// The job is of more than a pen on one side of the arm's singularities.
pub fn corrected(job: &Job, start: [f64; 2], factors: [f64; 2]) -> Result<String, CorrectionError> {
    let middle = middle(job);
    let mut text = String::from(
        "; Corrected by `fivebar photo`, in the frame of the base: draw it with --origin 0,0\nG21\nG90\nM5\n",
    );
    let (mut at, mut is_down) = (start, false);
    for step in &job.steps {
        if step.tool > 0.0 && step.tool < 1.0 {
            return Err(CorrectionError::Power(step.line));
        }
        if step.draws() != is_down {
            is_down = step.draws();
            text += if is_down { "M3\n" } else { "M5\n" };
        }
        let feed = match step.action {
            Action::Line { feed, .. } => feed,
            Action::Arc { feed, .. } => Some(feed),
            Action::Dwell { duration } => {
                let _ = writeln!(text, "G4 S{duration:.3}");
                continue;
            }
            Action::ChangeMode(_) | Action::Cross { .. } => {
                return Err(CorrectionError::Mode(step.line));
            }
        };
        let end = step.action.end().unwrap_or(at);
        for point in points_of(at, &step.action, end) {
            let smaller = (point - middle).component_div(&Vector2::from(factors));
            let [x, y] = (1e3 * (middle + smaller)).into();
            let _ = match feed {
                None => writeln!(text, "G0 X{x:.4} Y{y:.4}"),
                Some(feed) => writeln!(text, "G1 X{x:.4} Y{y:.4} F{:.3}", 6e4 * feed),
            };
        }
        at = end;
    }
    text += "M5\n";
    Ok(text)
}

/// The middle of the ends of what is drawn [m].
fn middle(job: &Job) -> Vector2<f64> {
    let ends = job.steps.iter().filter(|step| step.draws());
    let ends = ends.filter_map(|step| step.action.end().map(Vector2::from));
    let corners = ends.fold(None, |corners: Option<[Vector2<f64>; 2]>, end| {
        let [low, high] = corners.unwrap_or([end; 2]);
        Some([low.inf(&end), high.sup(&end)])
    });
    corners.map_or_else(Vector2::zeros, |[low, high]| 0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::{CorrectionError, corrected, middle};
    use fivebar_files::job::{Action, Job, Placement};

    const PLACEMENT: Placement = Placement {
        origin: [0.0; 2],
        scale: 1.0,
        turn: 0.0,
        home: [0.0; 2],
    };

    fn job(text: &str) -> Job {
        Job::parse(text, &PLACEMENT).unwrap()
    }

    /// On paper that grows it is the job again.
    #[test]
    fn a_corrected_job_on_paper_that_grows_is_the_job() {
        let job = job(
            "G21 G90 F600\nG0 X10 Y120\nM3\nG1 X50\nG2 X90 Y160 I0 J40\nG4 S0.2\nM5\nG0 X10 Y120\n",
        );
        let factors = [1.005, 1.003];
        let smaller = self::job(&corrected(&job, [0.0; 2], factors).unwrap());
        let center = middle(&job);
        let grown = |[x, y]: [f64; 2]| {
            [
                center.x + factors[0] * (x - center.x),
                center.y + factors[1] * (y - center.y),
            ]
        };
        let drawn = |job: &Job| -> Vec<[f64; 2]> {
            let steps = job.steps.iter().filter(|step| step.draws());
            steps.filter_map(|step| step.action.end()).collect()
        };
        let points: Vec<_> = drawn(&smaller).into_iter().map(grown).collect();
        let is_at = |[x, y]: [f64; 2], point: [f64; 2]| (x - point[0]).hypot(y - point[1]) < 1e-6;
        assert!(is_at(points[0], [0.05, 0.12]));
        assert!(is_at(points[points.len() - 1], [0.09, 0.16]));
        // The arc, about (50, 160) mm.
        assert!(points.len() > 20);
        for [x, y] in &points {
            assert!(((x - 0.05).hypot(y - 0.16) - 0.04).abs() < 1e-6, "{x}, {y}");
        }
        let rests = smaller.steps.iter().filter(|step| {
            matches!(step.action, Action::Dwell { duration } if (duration - 0.2).abs() < 1e-9)
        });
        assert_eq!(rests.count(), 1);
    }

    #[test]
    fn a_job_with_powers_is_refused() {
        let job = job("G21 G90 F600\nM3 S500\nG1 X10 Y120\nM3 S1000\nG1 X50\nM5\n");
        let powers = job
            .steps
            .iter()
            .any(|step| step.tool > 0.0 && step.tool < 1.0);
        let refused = corrected(&job, [0.0; 2], [1.0; 2]);
        assert_eq!(powers, matches!(refused, Err(CorrectionError::Power(_))));
    }
}
