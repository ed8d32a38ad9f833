//! Along a job: the same analysis at its feed rates, and where pins change sides.

use super::state::{Analysis, State, analyse};
use crate::input::job::{Action, Job};
use crate::input::robot::Robot;
use fivebar_kinematics::trajectory::{PathSegment, Sense};
use nalgebra::Vector2;

/// Samples are no farther apart than this along the path [m] …
const SPACING: f64 = 1e-3;
/// … nor more than this in all.
const MOST: usize = 4000;

/// Radii of an arc's ends may differ by this, as in a planned move [m].
const ARC_MISMATCH: f64 = 1e-4;

/// One place of the path.
#[derive(Clone, Debug)]
pub struct Station {
    /// Distance along the path [m].
    pub distance: f64,
    /// The line of the job.
    pub line: u32,
    /// What is there.
    pub analysis: Analysis,
}

/// A joint whose reaction turns about: its pin leaves one side of the bearing for the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// 0 to 4 for A to E.
    pub joint: usize,
    /// Distance along the path [m].
    pub distance: f64,
    /// The line of the job.
    pub line: u32,
}

/// The analysis along a path.
#[derive(Clone, Debug)]
pub struct Along {
    /// Its places in order.
    pub stations: Vec<Station>,
    /// Where contact is expected to be lost.
    pub flips: Vec<Flip>,
}

/// Analyses a job's motion under a constant force on the tool [N].
///
/// The tool is taken to move at the feed rate all along, turning where the path turns;
/// ramps at corners are left out.
///
/// # Errors
/// A sentence naming the first line that cannot be analysed.
pub fn along(robot: &Robot, job: &Job, force: Vector2<f64>) -> Result<Along, String> {
    let mut pieces = Vec::new();
    let mut from: Option<Vector2<f64>> = None;
    for step in &job.steps {
        let (to, feed) = match step.action {
            Action::Line { to, feed } => (to, feed.unwrap_or(robot.motion.max_speed)),
            Action::Arc { to, feed, .. } => (to, feed),
            Action::Dwell { .. } => continue,
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
    let spacing = SPACING.max(total / MOST as f64);
    let mut stations: Vec<Station> = Vec::new();
    let mut flips = Vec::new();
    let mut done = 0.0;
    for (line, segment, feed) in pieces {
        let count = (segment.length() / spacing).ceil().max(1.0) as usize;
        for index in 0..=count {
            let s = segment.length() * index as f64 / count as f64;
            let here = segment.at(s);
            let state = State {
                position: here.position,
                velocity: here.tangent * feed,
                acceleration: here.curvature * (feed * feed),
                force,
            };
            let analysis =
                analyse(robot, &state).map_err(|error| format!("line {line}: {error}"))?;
            let distance = done + s;
            if let Some(before) = stations.last() {
                let turned = turned_about(&before.analysis, &analysis);
                flips.extend(turned.map(|joint| Flip {
                    joint,
                    distance,
                    line,
                }));
            }
            stations.push(Station {
                distance,
                line,
                analysis,
            });
        }
        done += segment.length();
    }
    if stations.is_empty() {
        return Err("the job has no path: nothing follows its first point".into());
    }
    Ok(Along { stations, flips })
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
fn turned_about<'a>(before: &'a Analysis, after: &'a Analysis) -> impl Iterator<Item = usize> + 'a {
    let forces = before.forces.as_ref().zip(after.forces.as_ref());
    forces.into_iter().flat_map(|(before, after)| {
        (0..5).filter(move |&joint| {
            before.equilibrium.reactions[joint].dot(&(after.equilibrium.reactions[joint])) < 0.0
        })
    })
}
