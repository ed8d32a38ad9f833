//! Bézier curves as lines, within a tolerance.
//!
//! A curve B(t) differs from the chord of an interval of length h by at most h²/8 · max |B″|. For a
//! cubic, |B″| ≤ 6 max(|P0 − 2 P1 + P2|, |P1 − 2 P2 + P3|); for a quadratic, B″ = 2 (P0 − 2 P1 + P2).
//! So many equal intervals are taken that this bound is the tolerance.

use crate::budget::{Budget, OverBudget};
use usvg::tiny_skia_path::{PathSegment, Point as PathPoint};

type Point = [f64; 2];

pub(super) struct Flattener {
    /// Greatest distance of a line from its curve [px].
    tolerance: f64,
    budget: Budget,
}

impl Flattener {
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            budget: Budget::points(),
        }
    }

    /// The polylines of a path, by `place` on the page [px].
    pub(super) fn strokes(
        &mut self,
        segments: impl Iterator<Item = PathSegment>,
        place: impl Fn(PathPoint) -> Point,
    ) -> Result<Vec<Vec<Point>>, OverBudget> {
        let mut strokes: Vec<Vec<Point>> = Vec::new();
        let mut start = [0.0; 2];
        for segment in segments {
            self.budget.take(1)?;
            if let PathSegment::MoveTo(to) = segment {
                start = place(to);
                strokes.push(vec![start]);
                continue;
            }
            // After a close without a move, the next stroke begins where the last one did.
            let stroke = match strokes.last_mut() {
                Some(stroke) => stroke,
                None => continue,
            };
            let from = stroke.last().copied().unwrap_or(start);
            match segment {
                PathSegment::MoveTo(_) => {}
                PathSegment::LineTo(to) => stroke.push(place(to)),
                PathSegment::QuadTo(control, to) => {
                    let [control, to] = [place(control), place(to)];
                    let bend = 2.0 * second_difference(from, control, to);
                    let count = self.intervals(bend)?;
                    stroke.extend((1..=count).map(|step| {
                        let t = step as f64 / count as f64;
                        blend(blend(from, control, t), blend(control, to, t), t)
                    }));
                }
                PathSegment::CubicTo(first, second, to) => {
                    let [first, second, to] = [place(first), place(second), place(to)];
                    let bends = [
                        second_difference(from, first, second),
                        second_difference(first, second, to),
                    ];
                    let count = self.intervals(6.0 * bends[0].max(bends[1]))?;
                    stroke.extend((1..=count).map(|step| {
                        let t = step as f64 / count as f64;
                        let [a, b] = [blend(from, first, t), blend(first, second, t)];
                        let c = blend(second, to, t);
                        blend(blend(a, b, t), blend(b, c, t), t)
                    }));
                }
                PathSegment::Close => {
                    if from != start {
                        stroke.push(start);
                    }
                    strokes.push(vec![start]);
                }
            }
        }
        strokes.retain(|stroke| stroke.iter().any(|point| *point != stroke[0]));
        Ok(strokes)
    }

    /// The intervals of a curve with |B″| up to `bend` [px].
    fn intervals(&mut self, bend: f64) -> Result<usize, OverBudget> {
        let count = (bend / (8.0 * self.tolerance)).sqrt();
        Ok(self.budget.take_calculated(count)?.max(1))
    }
}

/// |P0 − 2 P1 + P2|
fn second_difference(p0: Point, p1: Point, p2: Point) -> f64 {
    let [x, y] = [0, 1].map(|axis| p0[axis] - 2.0 * p1[axis] + p2[axis]);
    x.hypot(y)
}

fn blend(a: Point, b: Point, t: f64) -> Point {
    [0, 1].map(|axis| a[axis] + t * (b[axis] - a[axis]))
}
