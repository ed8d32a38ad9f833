//! Strokes as a job: sorted for short travel, each pen's after those of the one before.

use super::motion::{MIN_LENGTH, within_reach};
use super::{
    Action, Job, JobError, JobOptions, Placement, Step, Stop, Warning, WarningKind, order,
};

/// A polyline [m].
pub(super) type Stroke = Vec<[f64; 2]>;

/// What one pen draws.
pub(super) struct Pen {
    pub(super) name: String,
    pub(super) strokes: Vec<Stroke>,
}

/// The job that draws the strokes of each pen, with a stop between two pens.
pub(super) fn job(
    mut pens: Vec<Pen>,
    warnings: Vec<Warning>,
    placement: &Placement,
    options: &JobOptions,
) -> Result<Job, JobError> {
    let mut job = Job {
        is_drawing: true,
        warnings,
        ..Job::default()
    };
    pens.retain(|pen| !pen.strokes.is_empty());
    if pens.len() > 1 {
        let names = pens.iter().map(|pen| pen.name.clone()).collect();
        job.warnings.push(Warning::at(0, WarningKind::Pens(names)));
    }
    let mut end = [0.0; 2];
    let mut at: Option<[f64; 2]> = None;
    let mut number = 0;
    for pen in pens {
        if number > 0 {
            job.stops.push(Stop {
                line: 2 * number + 1,
                before: job.steps.len(),
                code: "Pen change".into(),
                name: Some(pen.name),
            });
        }
        for stroke in order::sorted(pen.strokes, end) {
            number += 1;
            for (index, &point) in stroke.iter().enumerate() {
                end = point;
                let [x, y] = placement.place(point);
                let to = [checked(x)?, checked(y)?];
                if at.is_some_and(|at| (to[0] - at[0]).hypot(to[1] - at[1]) < MIN_LENGTH) {
                    continue;
                }
                at = Some(to);
                let draws = index > 0;
                job.steps.push(Step {
                    line: 2 * number - u32::from(!draws),
                    tool: f64::from(u8::from(draws)),
                    action: Action::Line {
                        to,
                        feed: options.speed.filter(|_| draws),
                    },
                });
            }
        }
    }
    Ok(job)
}

fn checked(coordinate: f64) -> Result<f64, JobError> {
    within_reach(coordinate).map_err(|error| JobError::Drawing(error.to_string()))
}
