//! The marks of a photograph: circles about one centre, found by their shape.
//!
//! A mark is two circles with radii as 1 : 2; the first mark has a third one, with radius 3. In a
//! photograph they are ellipses. The second moments of an ellipse turn it into a circle again, so the
//! test of a line of ink is affine: after that turn, all of its points are equally far from their mean.

use super::picture::Picture;
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::{SQRT_2, TAU};

/// The radius of the innermost circle of a mark, and the step to the next one [m].
pub const MARK_STEP: f64 = 2e-3;

/// Pixels of the picture in which marks are searched.
const PIXELS: usize = 4_000_000;
/// Greatest deviation of a circle's points from their mean radius, as a share of it: the line's width.
const ROUND: f64 = 0.2;
/// Sectors of a circle; ink must be in all.
const SECTORS: usize = 16;
/// Fewest pixels of a circle.
const FEWEST: usize = 24;
/// Greatest distance of the centres of two circles of a mark, as a share of the smaller radius.
const CONCENTRIC: f64 = 0.25;
/// Greatest deviation of a ratio of radii, as a share of it.
const RATIO: f64 = 0.12;

/// A mark as seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SeenMark {
    /// Its centre [pixels].
    pub(super) centre: Vector2<f64>,
    /// The mean radius of its innermost circle [pixels].
    pub(super) radius: f64,
    /// Whether it has the third circle.
    pub(super) is_first: bool,
}

/// A closed line that is a circle or an ellipse.
#[derive(Clone, Copy)]
struct Circle {
    centre: Vector2<f64>,
    radius: f64,
}

/// All marks in a picture.
pub(super) fn find(picture: &Picture) -> Vec<SeenMark> {
    let (small, factor) = picture.reduced(PIXELS);
    let circles = circles(&small);
    let partner = |inner: &Circle, ratio: f64| {
        circles.iter().copied().find(|outer| {
            (outer.centre - inner.centre).norm() < CONCENTRIC * inner.radius
                && (outer.radius / inner.radius / ratio - 1.0).abs() < RATIO
        })
    };
    let marks = circles.iter().filter_map(|inner| {
        let outer = partner(inner, 2.0)?;
        Some(SeenMark {
            centre: 0.5 * (inner.centre + outer.centre) * factor as f64,
            radius: inner.radius * factor as f64,
            is_first: partner(inner, 3.0).is_some(),
        })
    });
    marks.collect()
}

/// The lines of ink that are circles.
fn circles(picture: &Picture) -> Vec<Circle> {
    let [width, height] = picture.size();
    let mut left = picture.ink();
    let mut found = Vec::new();
    let mut line: Vec<usize> = Vec::new();
    for start in 0..left.len() {
        if !left[start] {
            continue;
        }
        // All ink that is connected with this pixel, by its eight neighbours.
        line.clear();
        line.push(start);
        left[start] = false;
        let mut next = 0;
        while let Some(&pixel) = line.get(next) {
            next += 1;
            let (row, column) = (pixel / width, pixel % width);
            for row in row.saturating_sub(1)..(row + 2).min(height) {
                for column in column.saturating_sub(1)..(column + 2).min(width) {
                    let other = row * width + column;
                    if std::mem::take(&mut left[other]) {
                        line.push(other);
                    }
                }
            }
        }
        let place = |&pixel: &usize| {
            Vector2::new((pixel % width) as f64 + 0.5, (pixel / width) as f64 + 0.5)
        };
        if line.len() >= FEWEST {
            found.extend(circle(&line.iter().map(place).collect::<Vec<_>>()));
        }
    }
    found
}

/// The circle of these points; none if they are none.
fn circle(points: &[Vector2<f64>]) -> Option<Circle> {
    let per_point = 1.0 / points.len() as f64;
    let centre = points.iter().sum::<Vector2<f64>>() * per_point;
    let moments: Matrix2<f64> = points
        .iter()
        .map(|p| (p - centre) * (p - centre).transpose())
        .sum::<Matrix2<f64>>()
        * per_point;
    let to_round = moments.cholesky()?.l().try_inverse()?;
    let mut sectors = [false; SECTORS];
    let (mut sum, mut squares) = (0.0, 0.0);
    for point in points {
        let round: Vector2<f64> = to_round * (point - centre);
        let radius = round.norm();
        sum += radius;
        squares += radius * radius;
        let turn = round.y.atan2(round.x).rem_euclid(TAU) / TAU;
        sectors[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] = true;
    }
    let mean = sum * per_point;
    let deviation = (squares * per_point - mean * mean).max(0.0).sqrt();
    let is_circle = deviation < ROUND * mean && sectors.iter().all(|&ink| ink);
    // Points all around at one radius r have the moments r²/2 along x and along y.
    let radius = SQRT_2 * moments.determinant().sqrt().sqrt();
    is_circle.then_some(Circle { centre, radius })
}
