//! The plane that a photograph shows.
//!
//! With w = (pixel − middle)/size, so that |w| is about 1, a photographed point lies at
//! q = (A w + b)/(1 + c·w): eight unknowns A (by rows), b, c. A lens that bends straight lines is
//! outside of this model.

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector2};

/// How many unknowns a photograph has.
pub(super) const UNKNOWNS: usize = 8;

type Vector8 = SVector<f64, UNKNOWNS>;

/// Points of a photograph in units of its size about their middle.
pub(super) fn normalised(pixels: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let per_count = 1.0 / pixels.len().max(1) as f64;
    let middle = pixels.iter().sum::<Vector2<f64>>() * per_count;
    let square: f64 = pixels.iter().map(|p| (p - middle).norm_squared()).sum();
    let size = (square * per_count).sqrt().max(f64::MIN_POSITIVE);
    pixels.iter().map(|p| (p - middle) / size).collect()
}

/// The position in the plane, with its derivatives by the eight unknowns; none where the photograph
/// shows infinity.
pub(super) fn in_plane(
    unknowns: &[f64],
    w: Vector2<f64>,
) -> Option<(Vector2<f64>, SMatrix<f64, 2, UNKNOWNS>)> {
    let [a11, a12, a21, a22, b1, b2, c1, c2] = *unknowns else {
        return None;
    };
    let divisor = 1.0 + c1 * w.x + c2 * w.y;
    let d = (divisor > 1e-6).then(|| 1.0 / divisor)?;
    let q = Vector2::new(a11 * w.x + a12 * w.y + b1, a21 * w.x + a22 * w.y + b2) * d;
    let (wx, wy) = (w.x * d, w.y * d);
    let jacobian = SMatrix::<f64, 2, UNKNOWNS>::from_row_slice(&[
        wx,
        wy,
        0.0,
        0.0,
        d,
        0.0,
        -q.x * wx,
        -q.x * wy, //
        0.0,
        0.0,
        wx,
        wy,
        0.0,
        d,
        -q.y * wx,
        -q.y * wy,
    ]);
    Some((q, jacobian))
}

/// The unknowns for which A w + b − q (c·w) = q, by least squares over points with their positions in the plane.
pub(super) fn start(points: &[(Vector2<f64>, Vector2<f64>)]) -> Option<Vector8> {
    let rows: Vec<f64> = points
        .iter()
        .flat_map(|(w, q)| {
            [
                [w.x, w.y, 0.0, 0.0, 1.0, 0.0, -q.x * w.x, -q.x * w.y],
                [0.0, 0.0, w.x, w.y, 0.0, 1.0, -q.y * w.x, -q.y * w.y],
            ]
        })
        .flatten()
        .collect();
    let matrix = DMatrix::from_row_slice(2 * points.len(), UNKNOWNS, &rows);
    let positions = points.iter().flat_map(|(_, q)| [q.x, q.y]);
    let wanted = DVector::from_iterator(2 * points.len(), positions);
    let found = matrix.svd(true, true).solve(&wanted, 1e-12).ok()?;
    Some(Vector8::from_column_slice(found.as_slice()))
}
