//! Points of the drawing in both directions, for a calibration.
//!
//! One stroke shows how far it lies aside, not along. Where strokes of different directions are near each
//! other, t = n·d of all of them gives the displacement d.

use super::compare::{Comparison, Deviation};
use nalgebra::{Matrix2, Vector2};
use std::collections::BTreeMap;

/// Side of the squares in which strokes are near each other [m].
const SQUARE: f64 = 6e-3;
/// Fewest points in a square.
const FEWEST: usize = 6;
/// Least mean square of a direction's part of the normals: 0.5 if all directions are alike.
const BOTH: f64 = 0.15;

/// A point that the tip drew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalPoint {
    /// The point of the job [m].
    pub place: Vector2<f64>,
    /// Where a lens without distortion shows the point that was drawn [pixels].
    pub pixel: Vector2<f64>,
}

/// The points of a comparison that are known in both directions.
pub fn local_points(comparison: &Comparison) -> Vec<LocalPoint> {
    let mut squares: BTreeMap<[i64; 2], Vec<&Deviation>> = BTreeMap::new();
    for deviation in &comparison.deviations {
        let square = deviation.place / SQUARE;
        let square = [square.x.floor() as i64, square.y.floor() as i64];
        squares.entry(square).or_default().push(deviation);
    }
    let points = squares.values().filter_map(|near| {
        let per_point = 1.0 / near.len() as f64;
        let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
        let mut place = Vector2::zeros();
        for deviation in near {
            normal += deviation.normal * deviation.normal.transpose() * per_point;
            right += deviation.normal * (deviation.error * per_point);
            place += deviation.place * per_point;
        }
        if near.len() < FEWEST || normal.symmetric_eigenvalues().min() < BOTH {
            return None;
        }
        let moved = normal.cholesky()?.solve(&right);
        let pixel = comparison.pixel_of(place + moved)?;
        Some(LocalPoint { place, pixel })
    });
    points.collect()
}
