//! Curves of DXF as lines [m].

use crate::budget::{Budget, OverBudget};
use std::f64::consts::TAU;

type Point = [f64; 2];

/// Highest degree of a spline.
const HIGHEST: usize = 9;
/// Most bisections of a span of a spline.
const MOST_BISECTIONS: u32 = 14;
/// Bisections of every span, before which a curve that turns back may look straight.
const LEAST_BISECTIONS: u32 = 2;

/// Points of an ellipse behind its first one: centre, half axes, parameters of start and end [rad].
pub(super) fn ellipse(
    center: Point,
    [major, minor]: [Point; 2],
    [from, to]: [f64; 2],
    tolerance: f64,
    budget: &mut Budget,
) -> Result<impl Iterator<Item = Point> + use<>, OverBudget> {
    let radius = major[0].hypot(major[1]).max(minor[0].hypot(minor[1]));
    // The sagitta of a chord over 2a is r (1 − cos a) ≤ r a²/2.
    let half = (2.0 * tolerance / radius.max(tolerance)).sqrt();
    let count = ((to - from).abs() / (2.0 * half)).max(8.0);
    let count = budget.take_calculated(count)?;
    Ok((0..=count).map(move |step| {
        let (sin, cos) = (from + (to - from) * step as f64 / count as f64).sin_cos();
        [0, 1].map(|axis| center[axis] + cos * major[axis] + sin * minor[axis])
    }))
}

/// Points of an arc of a circle, counter-clockwise from one angle to the other [rad].
pub(super) fn arc(
    center: Point,
    radius: f64,
    [from, to]: [f64; 2],
    tolerance: f64,
    budget: &mut Budget,
) -> Result<Vec<Point>, OverBudget> {
    let sweep = (to - from).rem_euclid(TAU);
    let sweep = if sweep < 1e-9 { TAU } else { sweep };
    let axes = [[radius, 0.0], [0.0, radius]];
    Ok(ellipse(center, axes, [from, from + sweep], tolerance, budget)?.collect())
}

/// Adds the piece of a polyline to `to`: an arc whose quarter angle has the tangent `bulge`.
pub(super) fn bulge(
    stroke: &mut Vec<Point>,
    to: Point,
    bulge: f64,
    tolerance: f64,
    budget: &mut Budget,
) -> Result<(), OverBudget> {
    let Some(&from) = stroke.last() else {
        stroke.push(to);
        return Ok(());
    };
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    if bulge.abs() > 1e-9 && dx.hypot(dy) > 0.0 {
        let share = (1.0 / bulge - bulge) / 4.0;
        let center = [
            (from[0] + to[0]) / 2.0 - share * dy,
            (from[1] + to[1]) / 2.0 + share * dx,
        ];
        let [x, y] = [from[0] - center[0], from[1] - center[1]];
        let axes = [[x, y], [-y, x]];
        let points = ellipse(center, axes, [0.0, 4.0 * bulge.atan()], tolerance, budget)?;
        stroke.extend(points.skip(1));
        stroke.pop();
    }
    stroke.push(to);
    Ok(())
}

/// A rational B-spline.
pub(super) struct Spline {
    pub(super) degree: usize,
    pub(super) knots: Vec<f64>,
    pub(super) points: Vec<Point>,
    pub(super) weights: Vec<f64>,
}

impl Spline {
    /// Whether its numbers fit together.
    pub(super) fn is_valid(&self) -> bool {
        let Self {
            degree,
            knots,
            points,
            weights,
        } = self;
        (1..=HIGHEST).contains(degree)
            && points.len() > *degree
            && knots.len() == points.len() + degree + 1
            && weights.len() == points.len()
            && weights.iter().all(|&weight| weight > 0.0)
            && knots.is_sorted()
            && knots[*degree] < knots[points.len()]
    }

    /// A point in the span from knot `span` on, by de Boor's algorithm.
    fn at(&self, span: usize, u: f64) -> Point {
        let mut row = [[0.0; 3]; HIGHEST + 1];
        for (column, index) in row.iter_mut().zip(span - self.degree..=span) {
            let ([x, y], weight) = (self.points[index], self.weights[index]);
            *column = [weight * x, weight * y, weight];
        }
        for level in 1..=self.degree {
            for index in (level..=self.degree).rev() {
                let low = self.knots[span - self.degree + index];
                let high = self.knots[span + 1 + index - level];
                let share = (u - low) / (high - low);
                row[index] = [0, 1, 2]
                    .map(|axis| (1.0 - share) * row[index - 1][axis] + share * row[index][axis]);
            }
        }
        let [x, y, weight] = row[self.degree];
        [x / weight, y / weight]
    }

    /// Its points.
    pub(super) fn stroke(
        &self,
        tolerance: f64,
        budget: &mut Budget,
    ) -> Result<Vec<Point>, OverBudget> {
        let mut stroke = Vec::new();
        for span in self.degree..self.points.len() {
            let [from, to] = [self.knots[span], self.knots[span + 1]];
            if from < to {
                let [first, center, last] = [from, 0.5 * (from + to), to].map(|u| self.at(span, u));
                budget.take(1)?;
                stroke.push(first);
                let piece = Piece {
                    span,
                    parameters: [from, to],
                    ends: [first, last],
                    center,
                    depth: 0,
                };
                self.divide(&piece, tolerance, &mut stroke, budget)?;
            }
        }
        Ok(stroke)
    }

    /// Adds the points from behind the first end to the last one.
    fn divide(
        &self,
        piece: &Piece,
        tolerance: f64,
        stroke: &mut Vec<Point>,
        budget: &mut Budget,
    ) -> Result<(), OverBudget> {
        let Piece {
            span,
            parameters: [from, to],
            ends,
            center,
            depth,
        } = *piece;
        // The time for a point grows with the square of the degree.
        budget.take(self.degree / 4)?;
        let quarters = [0.25, 0.75].map(|share| self.at(span, from + share * (to - from)));
        let is_near = |point: Point| distance(point, ends) < tolerance;
        let is_flat = || is_near(center) && quarters.into_iter().all(is_near);
        if depth >= MOST_BISECTIONS || depth >= LEAST_BISECTIONS && is_flat() {
            budget.take(1)?;
            stroke.push(ends[1]);
            return Ok(());
        }
        let middle = 0.5 * (from + to);
        let halves = [
            ([from, middle], [ends[0], center], quarters[0]),
            ([middle, to], [center, ends[1]], quarters[1]),
        ];
        for (parameters, ends, center) in halves {
            let half = Piece {
                span,
                parameters,
                ends,
                center,
                depth: depth + 1,
            };
            self.divide(&half, tolerance, stroke, budget)?;
        }
        Ok(())
    }
}

/// A piece of a curve that is divided until it is flat.
struct Piece {
    span: usize,
    /// Of its ends.
    parameters: [f64; 2],
    ends: [Point; 2],
    /// Where its middle parameter is.
    center: Point,
    /// How often the curve was divided in two for it.
    depth: u32,
}

/// The distance of a point from a line between two others.
fn distance([x, y]: Point, [[ax, ay], [bx, by]]: [Point; 2]) -> f64 {
    let [dx, dy] = [bx - ax, by - ay];
    let square = dx * dx + dy * dy;
    let share = if square > 0.0 {
        (((x - ax) * dx + (y - ay) * dy) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (x - ax - share * dx).hypot(y - ay - share * dy)
}
