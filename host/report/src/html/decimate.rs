//! Removes points of a curve that do not change its picture.

use super::Point;

/// Thins a curve to the resolution of `pixels` along each axis of its bounding box. A curve with
/// increasing x keeps the extremes of every column, so that no peak is lost. Of any other curve,
/// points within one pixel of the last kept point are dropped. Gaps are kept.
pub(crate) fn thin(points: &[Point], pixels: f64) -> Vec<Point> {
    let Some(range) = BoundingBox::of(points) else {
        return Vec::new();
    };
    let mut kept = Vec::new();
    for part in points.split(|point| !is_finite(point)) {
        if part.is_empty() {
            continue;
        }
        if !kept.is_empty() {
            kept.push([f64::NAN; 2]);
        }
        if part.windows(2).all(|pair| pair[0][0] <= pair[1][0]) {
            thin_columns(part, range.width() / pixels, &mut kept);
        } else {
            let step = [range.width() / pixels, range.height() / pixels];
            thin_path(part, step, &mut kept);
        }
    }
    kept
}

pub(crate) fn is_finite(point: &Point) -> bool {
    point[0].is_finite() && point[1].is_finite()
}

/// The bounding box of the finite points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundingBox {
    pub(crate) low: Point,
    pub(crate) high: Point,
}

impl BoundingBox {
    pub(crate) fn of<'a>(points: impl IntoIterator<Item = &'a Point>) -> Option<Self> {
        points
            .into_iter()
            .filter(|point| is_finite(point))
            .fold(None, |range, &point| {
                Some(range.map_or(
                    Self {
                        low: point,
                        high: point,
                    },
                    |Self { low, high }| Self {
                        low: [low[0].min(point[0]), low[1].min(point[1])],
                        high: [high[0].max(point[0]), high[1].max(point[1])],
                    },
                ))
            })
    }

    pub(crate) fn width(&self) -> f64 {
        self.high[0] - self.low[0]
    }

    pub(crate) fn height(&self) -> f64 {
        self.high[1] - self.low[1]
    }
}

/// The first, least, greatest and last point of each column, in their order along the curve.
fn thin_columns(points: &[Point], column: f64, kept: &mut Vec<Point>) {
    let column_of = |point: &Point| (point[0] / column).floor();
    for run in points.chunk_by(|a, b| column_of(a) == column_of(b)) {
        let by_height = |a: &usize, b: &usize| run[*a][1].total_cmp(&run[*b][1]);
        let least = (0..run.len()).min_by(by_height).unwrap_or(0);
        let greatest = (0..run.len()).max_by(by_height).unwrap_or(0);
        let mut chosen = [0, least, greatest, run.len() - 1];
        chosen.sort_unstable();
        let mut last = None;
        for index in chosen {
            if last != Some(index) {
                kept.push(run[index]);
            }
            last = Some(index);
        }
    }
}

fn thin_path(points: &[Point], step: Point, kept: &mut Vec<Point>) {
    let mut last: Option<Point> = None;
    for (index, &point) in points.iter().enumerate() {
        let near = last.is_some_and(|last| {
            (point[0] - last[0]).abs() < step[0] && (point[1] - last[1]).abs() < step[1]
        });
        if !near || index + 1 == points.len() {
            kept.push(point);
            last = Some(point);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{BoundingBox, Point, thin};

    #[test]
    fn a_peak_of_one_sample_in_a_long_signal_is_kept() {
        let mut signal: Vec<Point> = (0..100_000).map(|i| [f64::from(i), 0.0]).collect();
        signal[54_321][1] = 7.0;
        let thinned = thin(&signal, 500.0);
        assert!(thinned.len() <= 2_004, "{} points", thinned.len());
        assert_eq!(BoundingBox::of(&thinned), BoundingBox::of(&signal));
        assert!(thinned.contains(&[54_321.0, 7.0]));
    }

    #[test]
    fn a_thinned_path_differs_by_about_a_pixel() {
        let circle: Vec<Point> = (0..=10_000)
            .map(|i| f64::from(i) * 1e-3)
            .map(|angle| [angle.cos(), angle.sin()])
            .collect();
        let thinned = thin(&circle, 50.0);
        assert!(thinned.len() < circle.len() / 5);
        for point in &circle {
            let near = thinned
                .iter()
                .map(|kept| (kept[0] - point[0]).hypot(kept[1] - point[1]))
                .fold(f64::INFINITY, f64::min);
            assert!(near <= 2.0_f64.sqrt() * 2.0 / 50.0);
        }
        assert_eq!(thinned.last(), circle.last());
    }

    #[test]
    fn gaps_are_kept_and_a_curve_without_finite_points_is_empty() {
        let broken = [[0.0, 0.0], [f64::NAN, 0.0], [1.0, 1.0], [2.0, 1.0]];
        let thinned = thin(&broken, 100.0);
        assert_eq!(thinned.iter().filter(|point| point[0].is_nan()).count(), 1);
        assert!(thin(&[[f64::NAN, 1.0]], 100.0).is_empty());
        assert_eq!(thin(&[[3.0, 4.0]], 100.0), [[3.0, 4.0]]);
    }
}
