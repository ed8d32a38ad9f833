//! What the points determine, and how well: rank, condition, covariance.

use super::error::CalibrationError;
use super::parameters::{Parameters, SCALES};
use super::unknowns::Unknowns;
use nalgebra::{DMatrix, DVector, SMatrix, Vector2};

/// The Jacobian for unknowns in units of 0.1 m and 1 rad.
fn scaled(jacobian: &DMatrix<f64>, unknowns: Unknowns) -> DMatrix<f64> {
    let mut scaled = jacobian.clone();
    for (mut column, &index) in scaled.column_iter_mut().zip(unknowns.free()) {
        column *= SCALES[index];
    }
    scaled
}

/// Rank and condition of the scaled Jacobian.
pub(super) fn rank_and_condition(jacobian: &DMatrix<f64>, unknowns: Unknowns) -> (usize, f64) {
    let values = scaled(jacobian, unknowns).singular_values();
    let greatest = values.max();
    let rank = values.iter().filter(|&&value| value > LEAST * greatest);
    (rank.count(), greatest / values.min())
}

/// The least singular value that counts, relative to the greatest. The holes' errors of 1e-4 of
/// the arm's size make smaller ones meaningless.
const LEAST: f64 = 1e-6;

/// Refuses measurements that leave a combination of unknowns undetermined: a rank that is not
/// full, or a length known worse than to 5 % or an angle worse than to 0.05 rad.
pub(super) fn check_seen(
    jacobian: &DMatrix<f64>,
    unknowns: Unknowns,
    p: &Parameters,
    sigma: f64,
) -> Result<(), CalibrationError> {
    let matrix = scaled(jacobian, unknowns);
    let normal = matrix.tr_mul(&matrix).symmetric_eigen();
    let greatest = normal.eigenvalues.max().max(f64::MIN_POSITIVE);
    let (free, count) = (unknowns.free(), unknowns.free().len());
    let worst = |index: usize| match index {
        0..=4 => 0.05 * p.lengths[index] / SCALES[index],
        7 | 8 => f64::INFINITY,
        _ => 0.05,
    };
    // Directions that the points leave free, within what the worst bound allows.
    let mut share = vec![0.0_f64; count];
    let mut rank = count;
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
        let too_wide = (0..count).any(|i| sd * vector[i].abs() > worst(free[i]));
        if unseen || too_wide {
            rank -= 1;
            for (share, part) in share.iter_mut().zip(vector.iter()) {
                *share = share.max(part.abs());
            }
        }
    }
    if rank == count {
        return Ok(());
    }
    let names = unknowns.names().zip(share);
    let names = names.filter(|(_, share)| *share > 0.2);
    Err(CalibrationError::NotSeen {
        names: names.map(|(name, _)| name).collect(),
        rank,
        unknowns: count,
    })
}

/// σ² (JᵀJ)⁻¹ among all ten unknowns; the Jacobian has full rank.
pub(super) fn covariance(
    jacobian: &DMatrix<f64>,
    unknowns: Unknowns,
    sigma: f64,
) -> SMatrix<f64, 10, 10> {
    let matrix = scaled(jacobian, unknowns);
    let (free, count) = (unknowns.free(), unknowns.free().len());
    let inverse = matrix.tr_mul(&matrix).pseudo_inverse(0.0);
    let inverse = inverse.unwrap_or_else(|_| DMatrix::zeros(count, count));
    unknowns.among_ten(&DMatrix::from_fn(count, count, |i, j| {
        sigma * sigma * inverse[(i, j)] * SCALES[free[i]] * SCALES[free[j]]
    }))
}

/// The residuals of touches predicted from the others: (I − H_kk)⁻¹ r_k with
/// H = J (JᵀJ)⁻¹ Jᵀ.
pub(super) fn leave_out(
    r: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    unknowns: Unknowns,
) -> DVector<f64> {
    let matrix = scaled(jacobian, unknowns);
    let count = matrix.ncols();
    let inverse = matrix.tr_mul(&matrix).pseudo_inverse(0.0);
    let inverse = inverse.unwrap_or_else(|_| DMatrix::zeros(count, count));
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
