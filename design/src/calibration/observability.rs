//! What the points determine, and how well: rank, condition, covariance.

use super::error::CalibrationError;
use super::parameters::{PARAMETER_NAMES, Parameters, SCALES};
use nalgebra::{DMatrix, DVector, Vector2};

/// The Jacobian for unknowns in units of 0.1 m and 1 rad.
fn scaled(jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let mut scaled = jacobian.clone();
    for (mut column, scale) in scaled.column_iter_mut().zip(SCALES) {
        column *= scale;
    }
    scaled
}

/// Rank and condition of the scaled Jacobian.
pub(super) fn rank_and_condition(jacobian: &DMatrix<f64>) -> (usize, f64) {
    let values = scaled(jacobian).singular_values();
    let greatest = values.max();
    let rank = values.iter().filter(|&&value| value > LEAST * greatest);
    (rank.count(), greatest / values.min())
}

/// The least singular value that counts, relative to the greatest. The holes' errors of 1e-4 of
/// the arm's size make smaller ones meaningless.
const LEAST: f64 = 1e-6;

/// Refuses measurements that leave a combination of unknowns undetermined: a rank that is not
/// full, or a length known worse than to 5 % or an angle worse than to 0.05 rad. The unknowns are
/// all ten, or the seven of an arm without placement.
pub(super) fn check_seen(
    jacobian: &DMatrix<f64>,
    p: &Parameters,
    sigma: f64,
) -> Result<(), CalibrationError> {
    let matrix = scaled(jacobian);
    let normal = matrix.tr_mul(&matrix).symmetric_eigen();
    let greatest = normal.eigenvalues.max().max(f64::MIN_POSITIVE);
    let worst = |index: usize| match index {
        0..=4 => 0.05 * p.lengths[index] / SCALES[index],
        7 | 8 => f64::INFINITY,
        _ => 0.05,
    };
    // Directions that the points leave free, within what the worst bound allows.
    let unknowns = jacobian.ncols();
    let mut share = vec![0.0_f64; unknowns];
    let mut rank = unknowns;
    for (value, vector) in normal
        .eigenvalues
        .iter()
        .zip(normal.eigenvectors.column_iter())
    {
        let unseen = *value < LEAST * LEAST * greatest;
        let sd = if unseen {
            f64::INFINITY
        } else {
            sigma / value.sqrt()
        };
        let too_wide = (0..unknowns).any(|i| sd * vector[i].abs() > worst(i));
        if unseen || too_wide {
            rank -= 1;
            for (share, part) in share.iter_mut().zip(vector.iter()) {
                *share = share.max(part.abs());
            }
        }
    }
    if rank == unknowns {
        return Ok(());
    }
    let names = PARAMETER_NAMES.iter().zip(share);
    let names = names.filter(|(_, share)| *share > 0.2);
    Err(CalibrationError::NotSeen {
        names: names.map(|(name, _)| *name).collect(),
        rank,
        unknowns,
    })
}

/// σ² (JᵀJ)⁻¹; the Jacobian has full rank.
pub(super) fn covariance(jacobian: &DMatrix<f64>, sigma: f64) -> DMatrix<f64> {
    let matrix = scaled(jacobian);
    let unknowns = matrix.ncols();
    let inverse = matrix.tr_mul(&matrix).pseudo_inverse(0.0);
    let inverse = inverse.unwrap_or_else(|_| DMatrix::zeros(unknowns, unknowns));
    DMatrix::from_fn(unknowns, unknowns, |i, j| {
        sigma * sigma * inverse[(i, j)] * SCALES[i] * SCALES[j]
    })
}

/// The residuals of touches predicted from the others: (I − H_kk)⁻¹ r_k with
/// H = J (JᵀJ)⁻¹ Jᵀ.
pub(super) fn leave_out(r: &DVector<f64>, jacobian: &DMatrix<f64>) -> DVector<f64> {
    let matrix = scaled(jacobian);
    let inverse = matrix.tr_mul(&matrix).pseudo_inverse(0.0);
    let inverse = inverse.unwrap_or_else(|_| DMatrix::zeros(10, 10));
    let mut predicted = r.clone();
    for k in 0..r.len() / 2 {
        let rows = matrix.rows(2 * k, 2);
        let hat = rows * &inverse * rows.transpose();
        let rest = nalgebra::Matrix2::identity()
            - nalgebra::Matrix2::new(hat[(0, 0)], hat[(0, 1)], hat[(1, 0)], hat[(1, 1)]);
        let own = Vector2::new(r[2 * k], r[2 * k + 1]);
        // A touch without which the arm is not determined is not predicted.
        if let Some(inverse) = rest.try_inverse()
            && rest.determinant() > 1e-9
        {
            predicted
                .fixed_rows_mut::<2>(2 * k)
                .copy_from(&(inverse * own));
        }
    }
    predicted
}
