//! Polylines with fewer points: steps of pixels are smoothed, then points that lie on a line within a tolerance are left out
//! (D. Douglas and T. Peucker, 1973).

use super::Stroke;

/// Each point becomes the mean of itself, twice, and its neighbours; the ends of an open line stay.
pub(super) fn smoothed(points: &Stroke, is_closed: bool) -> Stroke {
    let count = points.len();
    if count < 3 {
        return points.clone();
    }
    let mean = |at: usize| {
        let [before, here, after] = [at + count - 1, at, at + 1].map(|it| points[it % count]);
        [0, 1].map(|axis| 0.25 * before[axis] + 0.5 * here[axis] + 0.25 * after[axis])
    };
    let middle = (0..count).map(|at| match !is_closed && (at == 0 || at == count - 1) {
        true => points[at],
        false => mean(at),
    });
    middle.collect()
}

/// The points without those that are within `tolerance` of the line between the others. The ends stay.
pub(super) fn simplified(points: &Stroke, tolerance: f64) -> Stroke {
    let Some(last) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut is_kept = vec![false; points.len()];
    (is_kept[0], is_kept[last]) = (true, true);
    let mut parts = vec![(0, last)];
    while let Some((from, to)) = parts.pop() {
        let far = (from + 1..to).map(|at| (distance(points[at], points[from], points[to]), at));
        let Some((far, at)) = far.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            continue;
        };
        if far > tolerance {
            is_kept[at] = true;
            parts.extend([(from, at), (at, to)]);
        }
    }
    let kept = points.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept);
    kept.map(|(&point, _)| point).collect()
}

/// The distance of a point from the line between two others, ends included.
pub(super) fn distance(point: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let [u, v] = [to[0] - from[0], to[1] - from[1]];
    let [x, y] = [point[0] - from[0], point[1] - from[1]];
    let square = u * u + v * v;
    let along = match square > 0.0 {
        true => ((x * u + y * v) / square).clamp(0.0, 1.0),
        false => 0.0,
    };
    (x - along * u).hypot(y - along * v)
}
