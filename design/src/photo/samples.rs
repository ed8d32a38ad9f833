//! Points along the strokes of a job at which a photograph can be compared with it.

use nalgebra::Vector2;
use std::collections::HashMap;

/// Distance of two points along a stroke [m].
pub(super) const SPACING: f64 = 5e-4;
/// No other ink lies within this distance of the line across a stroke [m]: half the width of a pen, and some.
const CLEAR: f64 = 0.8e-3;
/// The line must be clear to this multiple of its length, because the other ink is not at its place either.
const BEYOND: f64 = 1.4;
/// Points of a stroke that are no other ink, and those left out at its ends.
const OWN: usize = 2;
/// Least cosine of the angle between a stroke's directions before and behind a point: a corner has no normal.
const STRAIGHT: f64 = 0.85;
/// A stroke over itself, or over another one that was drawn twice, is one line [m].
const SAME: f64 = 3e-5;

/// A point of a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// The stroke, and the piece of it, from 0.
    pub(super) stroke: usize,
    pub(super) piece: usize,
    /// The point [m], and the unit vector to the left of the stroke.
    pub(super) place: Vector2<f64>,
    pub(super) normal: Vector2<f64>,
}

/// The points along all strokes [m] whose lines across them, of this half length [m], meet no other ink.
pub(super) fn samples(strokes: &[Vec<Vector2<f64>>], half: f64) -> Vec<Sample> {
    let strokes: Vec<_> = strokes.iter().map(|stroke| points(stroke)).collect();
    let cell = |place: Vector2<f64>| {
        let cell = place / (2.0 * CLEAR);
        [cell.x.floor() as i64, cell.y.floor() as i64]
    };
    let mut grid: HashMap<[i64; 2], Vec<(usize, usize)>> = HashMap::new();
    for (stroke, points) in strokes.iter().enumerate() {
        for (index, (place, _)) in points.iter().enumerate() {
            grid.entry(cell(*place)).or_default().push((stroke, index));
        }
    }
    let reach = BEYOND * half;
    let mut samples = Vec::new();
    for (stroke, points) in strokes.iter().enumerate() {
        for index in OWN..points.len().saturating_sub(OWN) {
            let (place, piece) = points[index];
            let along = points[index + 1].0 - points[index - 1].0;
            let Some(along) = along.try_normalize(1e-9) else {
                continue;
            };
            let [before, after] = [place - points[index - OWN].0, points[index + OWN].0 - place];
            if before.dot(&after) < STRAIGHT * before.norm() * after.norm() {
                continue;
            }
            let normal = Vector2::new(-along.y, along.x);
            let is_other = |&(other, at): &(usize, usize)| {
                let is_own = other == stroke && at.abs_diff(index) <= OWN;
                let away = strokes[other][at].0 - place;
                let across = normal.dot(&away);
                let beyond = (across.abs() - reach).max(0.0);
                !is_own && across.abs() > SAME && along.dot(&away).hypot(beyond) < CLEAR
            };
            let across = (-steps(reach)..=steps(reach))
                .map(|step| cell(place + normal * (f64::from(step) * CLEAR)));
            let is_alone = !across
                .flat_map(|[x, y]| {
                    (x - 1..=x + 1).flat_map(move |x| (y - 1..=y + 1).map(move |y| [x, y]))
                })
                .any(|cell| {
                    grid.get(&cell)
                        .is_some_and(|near| near.iter().any(is_other))
                });
            if is_alone {
                samples.push(Sample {
                    stroke,
                    piece,
                    place,
                    normal,
                });
            }
        }
    }
    samples
}

/// Steps of the line in which the grid is looked at.
fn steps(reach: f64) -> i32 {
    (reach / CLEAR).ceil() as i32
}

/// Points along a line at equal distances, each with the piece on which it lies.
fn points(line: &[Vector2<f64>]) -> Vec<(Vector2<f64>, usize)> {
    let mut points = Vec::new();
    let mut ahead = 0.0;
    for (piece, ends) in line.windows(2).enumerate() {
        let displacement = ends[1] - ends[0];
        let length = displacement.norm();
        while ahead <= length && length > 0.0 {
            points.push((ends[0] + displacement * (ahead / length), piece));
            ahead += SPACING;
        }
        ahead -= length;
    }
    points
}

/// The length of lines [m].
pub(super) fn length(lines: &[Vec<Vector2<f64>>]) -> f64 {
    let pieces = lines.iter().flat_map(|line| line.windows(2));
    pieces.map(|ends| (ends[1] - ends[0]).norm()).sum()
}

#[cfg(test)]
mod tests {
    use super::{SPACING, samples};
    use nalgebra::Vector2;

    fn line(from: [f64; 2], to: [f64; 2]) -> Vec<Vector2<f64>> {
        vec![Vector2::from(from), Vector2::from(to)]
    }

    #[test]
    fn points_near_other_ink_are_left_out() {
        let cross = [
            line([0.0, 0.0], [0.02, 0.0]),
            line([0.01, -0.01], [0.01, 0.01]),
        ];
        let found = samples(&cross, 1.5e-3);
        let along_x = found.iter().filter(|sample| sample.stroke == 0);
        let gap = |sample: &&super::Sample| (sample.place.x - 0.01).abs() < 0.9e-3;
        assert!(along_x.clone().count() > 25 && along_x.filter(gap).count() <= 1);
        // Two lines 2 mm apart are too near to each other, 3 mm are enough.
        for (apart, wanted) in [(2e-3, false), (3.2e-3, true)] {
            let pair = [
                line([0.0, 0.0], [0.02, 0.0]),
                line([0.0, apart], [0.02, apart]),
            ];
            assert_eq!(!samples(&pair, 1.5e-3).is_empty(), wanted, "{apart}");
        }
        // A corner has no normal.
        let corner = [vec![[0.0, 0.0], [0.01, 0.0], [0.01, 0.01]]
            .into_iter()
            .map(Vector2::from)
            .collect()];
        let at_corner =
            |sample: &super::Sample| (sample.place - Vector2::new(0.01, 0.0)).norm() < 0.9e-3;
        let found = samples(&corner, 1.5e-3);
        assert!(!found.is_empty() && !found.iter().any(at_corner));
        // A line drawn twice is one.
        let twice = [
            line([0.0, 0.0], [0.02, 0.0]),
            line([0.0201, 0.0], [0.0, 0.0]),
        ];
        let expected = (0.02 / SPACING) as usize - 3;
        assert!(samples(&twice, 1.5e-3).len() >= 2 * expected - 2);
    }
}
