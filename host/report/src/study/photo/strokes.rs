//! The strokes of a job as lines through points.

use fivebar_files::job::{Action, Job, arc};
use nalgebra::{Rotation2, Vector2};

/// The strokes of a job, each with the lines of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobStrokes {
    /// The strokes, each as a line through points [m].
    pub points: Vec<Vec<Vector2<f64>>>,
    /// The line of the file of each piece of each stroke.
    lines: Vec<Vec<u32>>,
    is_drawing: bool,
}

/// Greatest distance of a chord from its arc [m].
const CHORD: f64 = 5e-6;

impl JobStrokes {
    /// What [`JobStrokes::line`] counts: `line`, or `stroke` of an SVG, HPGL or DXF.
    pub fn unit(&self) -> &'static str {
        match self.is_drawing {
            true => "stroke",
            false => "line",
        }
    }

    /// The line of the file that draws this piece of a stroke; of an SVG, HPGL or DXF, the stroke.
    pub fn line(&self, stroke: usize, piece: usize) -> u32 {
        let lines = self.lines.get(stroke);
        let line = lines.and_then(|lines| lines.get(piece)).copied();
        match self.is_drawing {
            true => line.unwrap_or(0) / 2,
            false => line.unwrap_or(0),
        }
    }
}

/// The strokes of a job whose tool is at `start` before it [m].
pub fn strokes(job: &Job, start: [f64; 2]) -> JobStrokes {
    let mut strokes = JobStrokes {
        is_drawing: job.is_drawing,
        ..JobStrokes::default()
    };
    let mut at = start;
    let mut is_down = false;
    for step in &job.steps {
        let Some(end) = step.action.end() else {
            is_down &= matches!(step.action, Action::Dwell { .. });
            continue;
        };
        if step.draws() {
            if !is_down {
                strokes.points.push(vec![at.into()]);
                strokes.lines.push(Vec::new());
            }
            if let (Some(points), Some(lines)) =
                (strokes.points.last_mut(), strokes.lines.last_mut())
            {
                points.extend(points_of(at, &step.action, end));
                lines.resize(points.len() - 1, step.line);
            }
        }
        (at, is_down) = (end, step.draws());
    }
    strokes
}

/// The points of an action after its start.
pub(super) fn points_of(from: [f64; 2], action: &Action, end: [f64; 2]) -> Vec<Vector2<f64>> {
    let Action::Arc {
        center, clockwise, ..
    } = *action
    else {
        return vec![end.into()];
    };
    let (radius, angle) = arc::sweep(from, end, center, clockwise);
    let step = 2.0 * (1.0 - CHORD / radius.max(2.0 * CHORD)).acos();
    let count = (angle / step).ceil().max(1.0);
    let sign = if clockwise { -1.0 } else { 1.0 };
    let center = Vector2::from(center);
    let spoke = Vector2::from(from) - center;
    let point = |index: usize| {
        let turn = Rotation2::new(sign * angle * index as f64 / count);
        center + turn * spoke
    };
    (1..=count as usize).map(point).collect()
}
