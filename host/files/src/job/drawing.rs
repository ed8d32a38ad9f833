//! Strokes as a job: sorted for short travel, each pen's after those of the one before.

use super::motion::MIN_LENGTH;
use super::order::Order;
use super::{Action, Job, JobError, JobOptions, Placement, Step, Stop, Warning, WarningKind};
use crate::budget::{Budget, OverBudget};

/// Most pens: plotters have fewer.
const MOST_PENS: usize = 255;
/// Longer drawings [m] are a mistake in the units.
const LONGEST: f64 = 1e3;
/// Coordinates beyond this [m] are a mistake: no national grid has larger ones.
const FARTHEST: f64 = 1e8;

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
    let length = placement.scale * longest_side(&pens);
    if length > LONGEST {
        return Err(JobError::Drawing(format!(
            "the drawing is {length:.0} m long, out of reach of any arm: check its units"
        )));
    }
    copy(&mut pens, options)?;
    if pens.len() > MOST_PENS {
        let what = "the drawing has more layers than pens: all are drawn with one";
        job.warnings
            .push(Warning::at(0, WarningKind::Drawing(what.into())));
        let strokes = pens.into_iter().flat_map(|pen| pen.strokes).collect();
        let name = String::new();
        pens = vec![Pen { name, strokes }];
    }
    if pens.len() > 1 {
        let names = pens.iter().map(|pen| pen.name.clone()).collect();
        job.warnings.push(Warning::at(0, WarningKind::Pens(names)));
    }
    let mut end = [0.0; 2];
    let mut at: Option<[f64; 2]> = None;
    let mut number = 0;
    let mut order = Order::default();
    for pen in pens {
        if number > 0 {
            job.stops.push(Stop {
                line: 2 * number + 1,
                before: job.steps.len(),
                code: "Pen change".into(),
                name: Some(pen.name),
            });
        }
        for stroke in order.sorted(pen.strokes, end) {
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

/// The longer side of the box around all strokes [m].
fn longest_side(pens: &[Pen]) -> f64 {
    let [width, height] = sides(pens);
    width.max(height)
}

/// Width and height of the box around all strokes [m].
fn sides(pens: &[Pen]) -> [f64; 2] {
    let points = || pens.iter().flat_map(|pen| &pen.strokes).flatten();
    [0, 1].map(|axis| {
        let low = points()
            .map(|point| point[axis])
            .fold(f64::INFINITY, f64::min);
        let high = points()
            .map(|point| point[axis])
            .fold(f64::NEG_INFINITY, f64::max);
        (high - low).max(0.0)
    })
}

/// Each pen draws all copies before the next one: to the right of the drawing, and above it.
fn copy(pens: &mut [Pen], options: &JobOptions) -> Result<(), JobError> {
    let [columns, rows] = options.copies;
    if [columns, rows] == [1, 1] {
        return Ok(());
    }
    let points: usize = pens.iter().flat_map(|pen| &pen.strokes).map(Vec::len).sum();
    let copied = points as f64 * f64::from(columns) * f64::from(rows);
    let too_many = |over: OverBudget| JobError::Drawing(format!("the copies are too many: {over}"));
    Budget::points().take_calculated(copied).map_err(too_many)?;
    let [right, up] = sides(pens).map(|side| side + options.gap);
    for pen in pens {
        let first = std::mem::take(&mut pen.strokes);
        for row in 0..rows {
            for column in 0..columns {
                let [x, y] = [right * f64::from(column), up * f64::from(row)];
                let moved = |stroke: &Stroke| {
                    stroke
                        .iter()
                        .map(|point| [point[0] + x, point[1] + y])
                        .collect()
                };
                pen.strokes.extend(first.iter().map(moved));
            }
        }
    }
    Ok(())
}

fn checked(coordinate: f64) -> Result<f64, JobError> {
    within_earth(coordinate).map_err(JobError::Drawing)
}

/// The coordinate of a drawing [m], unless it is a mistake in the units. National coordinates have their
/// zero thousands of kilometres away; the drawing is moved to the arm.
pub(super) fn within_earth(coordinate: f64) -> Result<f64, String> {
    match coordinate.abs() <= FARTHEST {
        true => Ok(coordinate),
        false => Err(format!(
            "a point at {coordinate:e} m is farther away than any drawing: check the units"
        )),
    }
}
