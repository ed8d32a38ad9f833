//! The accuracy along a job at its feed rates, and the points at which pins lose contact.

use super::error::AccuracyStudyError;
use super::five_bar::analyse;
use fivebar_design::accuracy::five_bar::{AccuracyAnalysis, ToolState};
use fivebar_files::job::{Action, Job};
use fivebar_files::robot::Robot;
use fivebar_kinematics::trajectory::{PathSegment, Sense};
use nalgebra::Vector2;

/// Distance of the samples along the path [m]; greater if there would be too many samples.
const SPACING: f64 = 1e-3;
/// Most samples of a path.
const MAX_SAMPLES: usize = 4000;

/// Greatest difference of the two radii of an arc, as in a planned move [m].
const ARC_MISMATCH: f64 = 1e-4;

/// One point of the path.
#[derive(Clone, Debug)]
pub struct PathPoint {
    /// Distance along the path [m].
    pub distance: f64,
    /// The line of the job.
    pub line: u32,
    /// The analysis there.
    pub analysis: AccuracyAnalysis,
}

/// A joint whose reaction reverses: its pin leaves one side of the bearing and goes to the
/// other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLoss {
    /// The joint, 0 to 4 for A to E.
    pub joint_index: usize,
    /// Distance along the path [m].
    pub distance: f64,
    /// The line of the job.
    pub line: u32,
}

/// The analysis along a path.
#[derive(Clone, Debug)]
pub struct PathAccuracy {
    /// The points in order.
    pub points: Vec<PathPoint>,
    /// The points at which a loss of contact is expected.
    pub contact_losses: Vec<ContactLoss>,
}

/// Analyses a job's motion under a constant force on C [N].
///
/// C moves at the feed rate everywhere, with the acceleration of the path's curvature
/// and without ramps at corners.
///
/// # Errors
/// `Line` with the first line that cannot be analysed, `NoPath`, `ToolOffset`.
pub fn path_accuracy(
    robot: &Robot,
    job: &Job,
    force: Vector2<f64>,
) -> Result<PathAccuracy, AccuracyStudyError> {
    if robot.tool.offset != [0.0; 2] {
        return Err(AccuracyStudyError::ToolOffset);
    }
    let mut pieces = Vec::new();
    let mut from: Option<Vector2<f64>> = None;
    for step in &job.steps {
        let (to, feed) = match step.action {
            Action::Line { to, feed } => (to, feed.unwrap_or(robot.motion.max_speed)),
            Action::Arc { to, feed, .. } => (to, feed),
            Action::Dwell { .. } => continue,
            Action::ChangeMode(_) | Action::Cross { .. } => {
                return Err(AccuracyStudyError::ChangeOfMode(step.line));
            }
        };
        let to = Vector2::new(to[0], to[1]);
        if let Some(from) = from
            && let Some(segment) = segment(from, to, &step.action)
        {
            pieces.push((step.line, segment, feed));
        }
        from = Some(to);
    }
    let total: f64 = pieces.iter().map(|(_, segment, _)| segment.length()).sum();
    let spacing = SPACING.max(total / MAX_SAMPLES as f64);
    let mut points: Vec<PathPoint> = Vec::new();
    let mut contact_losses = Vec::new();
    let mut done = 0.0;
    for (line, segment, feed) in pieces {
        let count = (segment.length() / spacing).ceil().max(1.0) as usize;
        for index in 0..=count {
            let s = segment.length() * index as f64 / count as f64;
            let here = segment.at(s);
            let state = ToolState {
                position: here.position,
                velocity: here.tangent * feed,
                acceleration: here.curvature * (feed * feed),
                force,
            };
            let analysis = analyse(robot, &state).map_err(|error| AccuracyStudyError::Line {
                line,
                error: Box::new(error),
            })?;
            let distance = done + s;
            if let Some(before) = points.last() {
                let turned = turned_about(&before.analysis, &analysis);
                contact_losses.extend(turned.map(|joint_index| ContactLoss {
                    joint_index,
                    distance,
                    line,
                }));
            }
            points.push(PathPoint {
                distance,
                line,
                analysis,
            });
        }
        done += segment.length();
    }
    if points.is_empty() {
        return Err(AccuracyStudyError::NoPath);
    }
    Ok(PathAccuracy {
        points,
        contact_losses,
    })
}

fn segment(from: Vector2<f64>, to: Vector2<f64>, action: &Action) -> Option<PathSegment<f64>> {
    match *action {
        Action::Arc {
            center, clockwise, ..
        } => {
            let sense = if clockwise {
                Sense::Clockwise
            } else {
                Sense::CounterClockwise
            };
            let centre = Vector2::new(center[0], center[1]);
            PathSegment::arc(from, to, centre, sense, ARC_MISMATCH).ok()
        }
        _ => PathSegment::line(from, to).ok(),
    }
}

/// The joints whose reaction has turned by more than a right angle.
fn turned_about<'a>(
    before: &'a AccuracyAnalysis,
    after: &'a AccuracyAnalysis,
) -> impl Iterator<Item = usize> + 'a {
    let forces = before.forces.as_ref().zip(after.forces.as_ref());
    forces.into_iter().flat_map(|(before, after)| {
        (0..5).filter(move |&joint| {
            before.equilibrium.reactions[joint].dot(&(after.equilibrium.reactions[joint])) < 0.0
        })
    })
}
