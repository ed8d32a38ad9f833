//! What a job draws, as points: its extents, and its cells on a grid.

use crate::job::arc::sweep;
use crate::job::{Action, Job, Step};
use std::collections::BTreeSet;

/// Points along the longer side of a drawing.
const RESOLUTION: f64 = 400.0;

/// Points after which they are thinned: the cells of a grid of the resolution, and as many again.
const MOST_UNTHINNED: usize = 400_000;

/// Points along a drawing, close to each other, in the job's frame [m].
#[derive(Clone, Debug)]
pub(super) struct Outline {
    points: Vec<[f64; 2]>,
}

/// A box parallel to the axes: its lower left and its upper right corner [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

impl Extent {
    fn of(points: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        points
            .into_iter()
            .fold(None, |extent: Option<Self>, point| {
                let Self { low, high } = extent.unwrap_or(Self {
                    low: point,
                    high: point,
                });
                Some(Self {
                    low: [0, 1].map(|axis| low[axis].min(point[axis])),
                    high: [0, 1].map(|axis| high[axis].max(point[axis])),
                })
            })
    }

    /// Width and height [m].
    pub(super) fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.high[axis] - self.low[axis])
    }

    pub(super) fn middle(&self) -> [f64; 2] {
        [0, 1].map(|axis| 0.5 * (self.high[axis] + self.low[axis]))
    }
}

impl Outline {
    /// The outline of what a job draws, or of all its motions if it draws nothing.
    pub(super) fn of(job: &Job) -> Self {
        let draws = job.steps.iter().any(Step::draws);
        let spacing = ends(job, draws).map_or(0.0, |extent| {
            let [width, height] = extent.size();
            width.max(height) / RESOLUTION
        });
        let mut points = Vec::new();
        let mut at = None;
        for step in &job.steps {
            let Some(end) = step.action.end() else {
                continue;
            };
            if step.draws() || !draws {
                let from = at.unwrap_or(end);
                sample(from, &step.action, spacing, &mut points);
                if points.len() > MOST_UNTHINNED {
                    points = thinned(points, spacing);
                }
            }
            at = Some(end);
        }
        Self {
            points: thinned(points, spacing),
        }
    }

    /// The outline turned by `turn` [rad] and scaled.
    pub(super) fn placed(&self, turn: f64, scale: f64) -> Self {
        let (sin, cos) = turn.sin_cos();
        let place = |&[x, y]: &[f64; 2]| [scale * (cos * x - sin * y), scale * (sin * x + cos * y)];
        Self {
            points: self.points.iter().map(place).collect(),
        }
    }

    /// The points [m].
    pub(super) fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    pub(super) fn extent(&self) -> Extent {
        let none = Extent {
            low: [0.0; 2],
            high: [0.0; 2],
        };
        Extent::of(self.points.iter().copied()).unwrap_or(none)
    }

    /// The cells of the outline on a grid of this pitch [m], whose first cell has the outline's
    /// lower left corner at its centre.
    pub(super) fn cells(&self, pitch: f64) -> Vec<[i32; 2]> {
        let low = self.extent().low;
        let cell = |point: &[f64; 2]| {
            [0, 1].map(|axis| ((point[axis] - low[axis]) / pitch).round() as i32)
        };
        let cells: BTreeSet<[i32; 2]> = self.points.iter().map(cell).collect();
        cells.into_iter().collect()
    }
}

/// One point of each cell of this size [m], and the points that the extent depends on.
fn thinned(mut points: Vec<[f64; 2]>, size: f64) -> Vec<[f64; 2]> {
    let Some(Extent { low, high }) = Extent::of(points.iter().copied()) else {
        return points;
    };
    let mut cells = BTreeSet::new();
    // One point is enough on each side of the extent.
    let mut sides = [[false; 2]; 2];
    points.retain(|point| {
        let mut is_first = false;
        for axis in 0..2 {
            for (seen, side) in sides[axis].iter_mut().zip([low[axis], high[axis]]) {
                is_first |= point[axis] == side && !std::mem::replace(seen, true);
            }
        }
        let cell = point.map(|coordinate| (coordinate / size) as i64);
        cells.insert(cell) || is_first
    });
    points
}

/// The number of the first line after which the drawing is larger than `page` [m], in the frame
/// in which the job is placed.
pub(super) fn first_too_large(job: &Job, page: [f64; 2]) -> Option<u32> {
    let draws = job.steps.iter().any(Step::draws);
    let mut extent: Option<Extent> = None;
    let mut at = None;
    for step in &job.steps {
        let Some(end) = step.action.end() else {
            continue;
        };
        if step.draws() || !draws {
            let mut points = vec![at.unwrap_or(end)];
            sample(points[0], &step.action, f64::INFINITY, &mut points);
            let earlier = extent
                .into_iter()
                .flat_map(|extent| [extent.low, extent.high]);
            extent = Extent::of(earlier.chain(points));
            let size = extent.map_or([0.0; 2], |extent| extent.size());
            if size[0] > page[0] || size[1] > page[1] {
                return Some(step.line);
            }
        }
        at = Some(end);
    }
    None
}

fn ends(job: &Job, draws: bool) -> Option<Extent> {
    let steps = job.steps.iter().filter(|step| step.draws() || !draws);
    let points = steps.flat_map(|step| {
        let center = match step.action {
            Action::Arc { center, .. } => Some(center),
            _ => None,
        };
        step.action.end().into_iter().chain(center)
    });
    Extent::of(points)
}

/// Adds points along an action, at most `spacing` apart, and at least eight on an arc.
fn sample(from: [f64; 2], action: &Action, spacing: f64, points: &mut Vec<[f64; 2]>) {
    points.push(from);
    let count = |length: f64| (length / spacing).ceil().clamp(1.0, 4.0 * RESOLUTION) as u32;
    match *action {
        Action::Line { to, .. } => {
            let count = count((to[0] - from[0]).hypot(to[1] - from[1]));
            points.extend((1..=count).map(|step| {
                let t = f64::from(step) / f64::from(count);
                [0, 1].map(|axis| from[axis] + t * (to[axis] - from[axis]))
            }));
        }
        Action::Arc {
            to,
            center,
            clockwise,
            ..
        } => {
            let (radius, swept) = sweep(from, to, center, clockwise);
            let start = (from[1] - center[1]).atan2(from[0] - center[0]);
            let count = count(radius * swept).max(16);
            let sign = if clockwise { -1.0 } else { 1.0 };
            points.extend((1..=count).map(|step| {
                let turn = start + sign * swept * f64::from(step) / f64::from(count);
                [
                    center[0] + radius * turn.cos(),
                    center[1] + radius * turn.sin(),
                ]
            }));
        }
        // Of a crossing, whose path passes a singularity, its end.
        Action::Cross { to, .. } => points.push(to),
        Action::Dwell { .. } | Action::ChangeMode(_) => {}
    }
}
