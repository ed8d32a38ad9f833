//! The places of the marks from their measured distances.

use super::error::PhotoError;
use crate::fit::{Loss, minimise};
use nalgebra::{DMatrix, DVector, Vector2};

/// A measured distance between the centres of two marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkDistance {
    /// The marks, 0 to 3.
    pub between: [usize; 2],
    /// The distance [m].
    pub length: f64,
}

/// Five distances fix the shape of four points.
const FEWEST: usize = 5;
/// Greatest residual of a distance [m]: more is a slip, not a ruler's deviation.
const CREDIBLE: f64 = 1e-3;

/// The marks with these distances, placed at best over the marks as the job has them [m].
///
/// # Errors
/// Fewer than five different distances, and distances that contradict each other.
pub fn measured_marks(
    drawn: [Vector2<f64>; 4],
    distances: &[MarkDistance],
) -> Result<[Vector2<f64>; 4], PhotoError> {
    let mut pairs: Vec<[usize; 2]> = distances
        .iter()
        .map(|distance| {
            let [a, b] = distance.between;
            [a.min(b), a.max(b)]
        })
        .filter(|[a, b]| a < b && *b < 4)
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    let usable = distances
        .iter()
        .all(|d| d.length > 0.0 && d.length.is_finite());
    if pairs.len() < FEWEST || !usable {
        return Err(PhotoError::Distances(f64::NAN));
    }
    let start = DVector::from_iterator(8, drawn.iter().flat_map(|mark| [mark.x, mark.y]));
    let at = |x: &DVector<f64>, mark: usize| Vector2::new(x[2 * mark], x[2 * mark + 1]);
    let rows = |x: &DVector<f64>| {
        let mut residuals = DVector::zeros(distances.len());
        let mut jacobian = DMatrix::zeros(distances.len(), 8);
        for (row, distance) in distances.iter().enumerate() {
            let [a, b] = distance.between;
            let apart = at(x, a) - at(x, b);
            let unit = apart.try_normalize(1e-9)?;
            residuals[row] = apart.norm() - distance.length;
            for axis in 0..2 {
                jacobian[(row, 2 * a + axis)] += unit[axis];
                jacobian[(row, 2 * b + axis)] -= unit[axis];
            }
        }
        Some((residuals, jacobian))
    };
    let refused = PhotoError::Distances(f64::NAN);
    let (found, _) = minimise(&start, &rows, Loss::Squares).ok_or(refused)?;
    let (residuals, _) = rows(&found).ok_or(refused)?;
    let worst = residuals.amax();
    if worst > CREDIBLE {
        return Err(PhotoError::Distances(worst));
    }
    Ok(placed_over(
        [0, 1, 2, 3].map(|mark| at(&found, mark)),
        drawn,
    ))
}

/// The points, moved and turned so that the squares of their distances from the others are least.
fn placed_over(points: [Vector2<f64>; 4], others: [Vector2<f64>; 4]) -> [Vector2<f64>; 4] {
    let mean = |points: &[Vector2<f64>; 4]| 0.25 * points.iter().sum::<Vector2<f64>>();
    let (from, to) = (mean(&points), mean(&others));
    let pairs = points.iter().zip(&others);
    let (sin, cos) = pairs.fold((0.0, 0.0), |(sin, cos), (point, other)| {
        let (p, q) = (point - from, other - to);
        (sin + p.perp(&q), cos + p.dot(&q))
    });
    let turn = nalgebra::Rotation2::new(sin.atan2(cos));
    points.map(|point| to + turn * (point - from))
}

#[cfg(test)]
mod tests {
    use super::{MarkDistance, measured_marks};
    use crate::photo::PhotoError;
    use nalgebra::Vector2;

    #[test]
    fn distances_give_the_shape_and_the_job_the_placement() {
        let drawn = [[0.0, 0.1], [0.16, 0.1], [0.16, 0.2], [0.0, 0.2]].map(Vector2::from);
        // 1 % too wide: about the middle.
        let real = drawn.map(|p| Vector2::new(0.08 + 1.01 * (p.x - 0.08), p.y));
        let pairs = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]];
        let mut distances = pairs.map(|between| MarkDistance {
            between,
            length: (real[between[0]] - real[between[1]]).norm(),
        });
        for count in [5, 6] {
            let found = measured_marks(drawn, &distances[..count]).unwrap();
            for (found, real) in found.iter().zip(&real) {
                assert!((found - real).norm() < 1e-9, "{found}");
            }
        }
        assert!(measured_marks(drawn, &distances[..4]).is_err());
        distances[4].length += 0.01;
        let slip = measured_marks(drawn, &distances);
        assert!(matches!(slip, Err(PhotoError::Distances(worst)) if worst > 1e-3));
    }
}
