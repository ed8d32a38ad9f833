//! How many times larger than its job a drawing is, in x and in y: paper grows, across its fibres more than along them, and an
//! arm's lengths are off.
//!
//! The least squares of t − n·(a + φ Jq + (sx qx, sy qy)) over all points, with the error t along the normal n at the place q.
//! Errors of neighbours along a stroke are alike, so the deviations follow from sums over pieces of the strokes (Liang and
//! Zeger, *Biometrika* 73, 1986).

use super::compare::Deviation;
use nalgebra::{Matrix5, Vector2, Vector5};

/// Points of a piece of stroke whose errors are taken to be alike: 10 mm.
const ALIKE: usize = 20;
/// Fewest pieces from which deviations follow.
const FEWEST: usize = 10;

/// The scales of a drawing in the frame of its job.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Times as large as the job, in x and y.
    pub factors: [f64; 2],
    /// Their standard deviations by the errors of the strokes; those of the marks' places come besides.
    pub deviations: [f64; 2],
}

/// The scales; none if the strokes do not determine them.
pub(super) fn scales(found: &[Deviation]) -> Option<Scales> {
    if found.len() < FEWEST * ALIKE {
        return None;
    }
    let mean = found.iter().map(|d| d.place).sum::<Vector2<f64>>() / found.len() as f64;
    let row = |d: &Deviation| {
        let (n, q) = (d.normal, d.place - mean);
        Vector5::new(n.x, n.y, n.y * q.x - n.x * q.y, n.x * q.x, n.y * q.y)
    };
    let (mut normal, mut right) = (Matrix5::zeros(), Vector5::zeros());
    for deviation in found {
        let row = row(deviation);
        normal += row * row.transpose();
        right += row * deviation.error;
    }
    let factor = normal.cholesky()?;
    let solved = factor.solve(&right);
    let mut squares = Matrix5::zeros();
    for piece in found.chunks(ALIKE) {
        let sum: Vector5<f64> = piece
            .iter()
            .map(|d| row(d) * (d.error - row(d).dot(&solved)))
            .sum();
        squares += sum * sum.transpose();
    }
    let inverse = factor.inverse();
    let covariance = inverse * squares * inverse;
    Some(Scales {
        factors: [1.0 + solved[3], 1.0 + solved[4]],
        deviations: [covariance[(3, 3)].sqrt(), covariance[(4, 4)].sqrt()],
    })
}
