//! The job that draws the marks, and its marks read back.

use super::{PhotoStudyError, strokes};
use fivebar_design::photo::{MARK_STEP, MarkDistance, measured_marks};
use fivebar_files::job::{Action, Job, JobError, Placement, arc};
use fivebar_files::robot::Robot;
use fivebar_files::scenario::{RefusedMove, Scenario, ScenarioError};
use fivebar_firmware::Planner;
use nalgebra::Vector2;
use std::fmt::Write as _;

/// Why the marks cannot be placed or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MarksError {
    /// The job to be marked.
    #[error(transparent)]
    Job(#[from] ScenarioError),
    /// The robot has no settings.
    #[error("{0}")]
    Robot(String),
    /// The job draws nothing.
    #[error("the job draws nothing, so there is nothing to mark")]
    NoStrokes,
    /// No place for this mark.
    #[error(
        "there is no place for mark {0}: 9 mm beside the strokes and within reach. Draw smaller, with \
         --scale, or elsewhere, with --origin"
    )]
    NoPlace(usize),
    /// The arm does not get from mark to mark.
    #[error("the arm cannot draw all marks in turn: {0}; draw elsewhere, with --origin")]
    Refused(String),
    /// The file of the marks is no job.
    #[error("the marks' job, {0}")]
    Read(JobError),
    /// The file has other circles than four marks.
    #[error(
        "the marks' job has no four marks of two circles, one of them with a third: it must be the file \
         that --draw-marks wrote"
    )]
    Other,
    /// A mark of a measured distance.
    #[error("the marks have the numbers 1 to 4, not {0}")]
    Number(f64),
}

/// From the centre of a mark to the nearest stroke [m].
const CLEAR: f64 = 3.0 * MARK_STEP + 3e-3;
/// How far the marks lie outside of the drawing's corners at best, along x and y [m].
const OUTSIDE: f64 = 10e-3;
/// Distance of the places that are tried [m].
const PITCH: f64 = 2e-3;
/// Speed along the circles [mm/min].
const FEED: f64 = 1200.0;
/// Drawn twice at the end of each circle, so that it is closed [rad].
const OVERLAP: f64 = 0.35;

/// The job that draws the four marks around a scenario's job, as G-code in the frame of the base, and their
/// places [m]. The first one, lower left, has three circles; the others follow counter-clockwise.
///
/// # Errors
/// The job draws nothing, or the arm has no place for the marks.
pub fn marks_job(scenario: &Scenario) -> Result<(String, [Vector2<f64>; 4]), MarksError> {
    let job = scenario.job()?;
    let start = scenario.home_point().unwrap_or_default().map(f64::from);
    let points: Vec<Vector2<f64>> = strokes(&job, start).points.concat();
    let robot = &scenario.robot;
    let settings = robot
        .settings()
        .map_err(|error| MarksError::Robot(error.to_string()))?;
    let settings = settings
        .check()
        .map_err(|error| MarksError::Robot(error.to_string()))?;
    let mut planner = Planner::new(&settings);
    let low = points.iter().copied().reduce(|a, b| a.inf(&b));
    let high = points.iter().copied().reduce(|a, b| a.sup(&b));
    let (Some(low), Some(high)) = (low, high) else {
        return Err(MarksError::NoStrokes);
    };
    let (low, high) = (low.add_scalar(-OUTSIDE), high.add_scalar(OUTSIDE));
    let corners = [
        [low.x, low.y],
        [high.x, low.y],
        [high.x, high.y],
        [low.x, high.y],
    ];
    let middle = 0.5 * (low + high);
    let mut marks = [Vector2::zeros(); 4];
    for (number, corner) in corners.into_iter().enumerate() {
        let corner = Vector2::from(corner);
        // Places of this quarter, those nearest to its corner first.
        let inward = middle - corner;
        let [columns, rows] = [inward.x, inward.y].map(|side| (side.abs() / PITCH) as usize);
        let place = |index: usize| {
            let (column, row) = (index % (columns + 1), index / (columns + 1));
            let step = Vector2::new(column as f64, row as f64) * PITCH;
            corner + step.component_mul(&inward.map(f64::signum))
        };
        let mut places: Vec<_> = (0..(columns + 1) * (rows + 1)).map(place).collect();
        let away = |place: &Vector2<f64>| (place - corner).norm();
        places.sort_by(|a, b| away(a).total_cmp(&away(b)));
        let mut fits = |place: &Vector2<f64>| {
            points.iter().all(|point| (point - place).norm() >= CLEAR)
                && drawn(robot, &mut planner, &text(&[*place])).is_ok()
        };
        let found = places.into_iter().find(|place| fits(place));
        marks[number] = found.ok_or(MarksError::NoPlace(number + 1))?;
    }
    let marks = marks.map(|mark| mark.map(|x| 1e-6 * (1e6 * x).round()));
    let text = text(&marks);
    drawn(robot, &mut planner, &text)?;
    Ok((text, marks))
}

/// The places of the marks with measured distances: rows of two marks, counted from 1, and the length between them [m].
///
/// # Errors
/// A mark that is none of the four, or distances that do not determine the places.
pub fn measured_places(
    drawn: [Vector2<f64>; 4],
    rows: &[[f64; 3]],
) -> Result<[Vector2<f64>; 4], PhotoStudyError> {
    let mark = |number: f64| {
        let found = [1.0, 2.0, 3.0, 4.0].iter().position(|mark| *mark == number);
        found.ok_or(MarksError::Number(number))
    };
    let distances = rows
        .iter()
        .map(|&[from, to, length]| {
            let between = [mark(from)?, mark(to)?];
            Ok(MarkDistance { between, length })
        })
        .collect::<Result<Vec<_>, MarksError>>()?;
    Ok(measured_marks(drawn, &distances)?)
}

/// Whether the arm can draw a job in the frame of its base.
fn drawn(robot: &Robot, planner: &mut Planner, text: &str) -> Result<(), MarksError> {
    let mut scenario = Scenario::new("marks", robot.clone(), "the marks", text.into());
    scenario.origin = Some([0.0; 2]);
    let refused = |error: RefusedMove| MarksError::Refused(error.to_string());
    scenario.verify(planner, &scenario.job()?).map_err(refused)
}

/// The marks as G-code.
fn text(marks: &[Vector2<f64>]) -> String {
    let mut text = String::from(
        "; Marks for `fivebar photo`, in the frame of the base: draw them with --origin 0,0\nG21\nG90\nM5\n",
    );
    for (number, mark) in marks.iter().enumerate() {
        let [x, y] = [1e3 * mark.x, 1e3 * mark.y];
        let _ = writeln!(text, "; mark {} at ({x:.3}, {y:.3}) mm", number + 1);
        for circle in 1..=if number == 0 { 3 } else { 2 } {
            let radius = 1e3 * MARK_STEP * f64::from(circle);
            let (sin, cos) = OVERLAP.sin_cos();
            let (right, more) = (x + radius, [x + radius * cos, y + radius * sin]);
            let _ = writeln!(
                text,
                "G0 X{right:.3} Y{y:.3}\nM3\nG4 S0.1\nG3 I{:.3} J0 F{FEED}\nG3 X{:.3} Y{:.3} I{:.3} J0\nM5",
                -radius, more[0], more[1], -radius
            );
        }
    }
    text
}

/// The marks of a job that [`marks_job`] has written, the first one first [m].
///
/// # Errors
/// The text is no job, or has other circles.
pub fn marks_of(text: &str) -> Result<[Vector2<f64>; 4], MarksError> {
    let placement = Placement {
        origin: [0.0; 2],
        scale: 1.0,
        turn: 0.0,
        home: [0.0; 2],
    };
    let job = Job::parse(text, &placement).map_err(MarksError::Read)?;
    let mut marks: Vec<(Vector2<f64>, f64)> = Vec::new();
    let mut at = [0.0; 2];
    for step in &job.steps {
        if let Action::Arc {
            to,
            center,
            clockwise,
            ..
        } = step.action
        {
            let (radius, _) = arc::sweep(at, to, center, clockwise);
            let center = Vector2::from(center);
            let near = |mark: &&mut (Vector2<f64>, f64)| (mark.0 - center).norm() < 0.1 * MARK_STEP;
            match marks.iter_mut().find(near) {
                Some(mark) => mark.1 = mark.1.max(radius),
                None => marks.push((center, radius)),
            }
        }
        at = step.action.end().unwrap_or(at);
    }
    let has_third = |mark: &(Vector2<f64>, f64)| mark.1 > 2.5 * MARK_STEP;
    marks.sort_by_key(|mark| !has_third(mark));
    let firsts = marks.iter().filter(|mark| has_third(mark)).count();
    match <[_; 4]>::try_from(marks) {
        Ok(marks) if firsts == 1 => Ok(marks.map(|(centre, _)| centre)),
        _ => Err(MarksError::Other),
    }
}

#[cfg(test)]
mod tests {
    use super::{MarksError, marks_job, marks_of};
    use fivebar_files::job::DEMONSTRATION;
    use fivebar_files::robot::Robot;
    use fivebar_files::scenario::Scenario;

    #[test]
    fn the_marks_are_read_back_from_their_job() {
        let robot = Robot::load("benchtop").unwrap();
        let scenario = Scenario::new("", robot, "", DEMONSTRATION.into());
        let (text, marks) = marks_job(&scenario).unwrap();
        let read = marks_of(&text).unwrap();
        for (read, mark) in read.iter().zip(&marks) {
            assert!((read - mark).norm() < 1e-6, "{read} {mark}");
        }
        assert!(marks[1].x > marks[0].x + 0.06 && marks[3].y > marks[0].y + 0.04);
        let other = marks_of(DEMONSTRATION);
        assert!(matches!(other, Err(MarksError::Other)));
    }
}
