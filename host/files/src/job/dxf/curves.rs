//! Curves of DXF as lines [m].

use std::f64::consts::TAU;

type Point = [f64; 2];

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
) -> impl Iterator<Item = Point> {
    let radius = major[0].hypot(major[1]).max(minor[0].hypot(minor[1]));
    // The sagitta of a chord over 2a is r (1 − cos a) ≤ r a²/2.
    let half = (2.0 * tolerance / radius.max(tolerance)).sqrt();
    let count = ((to - from).abs() / (2.0 * half)).ceil().max(8.0) as u32;
    (0..=count).map(move |step| {
        let (sin, cos) = (from + (to - from) * f64::from(step) / f64::from(count)).sin_cos();
        [0, 1].map(|axis| center[axis] + cos * major[axis] + sin * minor[axis])
    })
}

/// Points of an arc of a circle, counter-clockwise from one angle to the other [rad].
pub(super) fn arc(
    center: Point,
    radius: f64,
    [from, to]: [f64; 2],
    tolerance: f64,
) -> impl Iterator<Item = Point> {
    let sweep = (to - from).rem_euclid(TAU);
    let sweep = if sweep < 1e-9 { TAU } else { sweep };
    let axes = [[radius, 0.0], [0.0, radius]];
    ellipse(center, axes, [from, from + sweep], tolerance)
}

/// Adds the piece of a polyline to `to`: an arc whose quarter angle has the tangent `bulge`.
pub(super) fn bulge(stroke: &mut Vec<Point>, to: Point, bulge: f64, tolerance: f64) {
    let Some(&from) = stroke.last() else {
        return stroke.push(to);
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
        let points = ellipse(center, axes, [0.0, 4.0 * bulge.atan()], tolerance);
        stroke.extend(points.skip(1));
        stroke.pop();
    }
    stroke.push(to);
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
        (1..=9).contains(degree)
            && points.len() > *degree
            && knots.len() == points.len() + degree + 1
            && weights.len() == points.len()
            && weights.iter().all(|&weight| weight > 0.0)
            && knots.is_sorted()
            && knots[*degree] < knots[points.len()]
    }

    /// A point in the span from knot `span` on, by de Boor's algorithm.
    fn at(&self, span: usize, u: f64) -> Point {
        let mut row: Vec<[f64; 3]> = (span - self.degree..=span)
            .map(|index| {
                let ([x, y], weight) = (self.points[index], self.weights[index]);
                [weight * x, weight * y, weight]
            })
            .collect();
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
    pub(super) fn stroke(&self, tolerance: f64) -> Vec<Point> {
        let mut stroke = Vec::new();
        for span in self.degree..self.points.len() {
            let [from, to] = [self.knots[span], self.knots[span + 1]];
            if from < to {
                stroke.push(self.at(span, from));
                let piece = Piece {
                    span,
                    parameters: [from, to],
                    depth: 0,
                };
                self.divide(&piece, tolerance, &mut stroke);
            }
        }
        stroke
    }

    /// Adds the points from behind the first end to the last one.
    fn divide(&self, piece: &Piece, tolerance: f64, stroke: &mut Vec<Point>) {
        let Piece {
            span,
            parameters: [from, to],
            depth,
        } = *piece;
        let at = |share: f64| self.at(span, from + share * (to - from));
        let ends = [self.at(span, from), self.at(span, to)];
        let is_flat = [0.25, 0.5, 0.75]
            .iter()
            .all(|&share| distance(at(share), ends) < tolerance);
        if depth >= MOST_BISECTIONS || depth >= LEAST_BISECTIONS && is_flat {
            return stroke.push(ends[1]);
        }
        let middle = 0.5 * (from + to);
        for parameters in [[from, middle], [middle, to]] {
            let half = Piece {
                span,
                parameters,
                depth: depth + 1,
            };
            self.divide(&half, tolerance, stroke);
        }
    }
}

/// A piece of a curve that is divided until it is flat.
struct Piece {
    span: usize,
    /// Of its ends.
    parameters: [f64; 2],
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
