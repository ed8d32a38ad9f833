//! What measurements of any kinds determine of the arm.

use crate::calibration::error::CalibrationError;
use crate::calibration::observability::{check_seen, covariance, rank_and_condition};
use crate::calibration::parameters::Parameters;
use crate::calibration::unknowns::Unknowns;
use nalgebra::{DMatrix, SMatrix};

/// The Jacobian of the arm's unknowns, its first columns, without what the other unknowns can take
/// up: P = (I − N N⁺) J.
pub(super) fn without_nuisances(jacobian: &DMatrix<f64>, arm: usize) -> DMatrix<f64> {
    let own = jacobian.columns(0, arm).into_owned();
    let mut others = jacobian.columns(arm, jacobian.ncols() - arm).into_owned();
    if others.ncols() == 0 {
        return own;
    }
    for mut column in others.column_iter_mut() {
        column /= column.norm().max(f64::MIN_POSITIVE);
    }
    let svd = others.svd(true, false);
    let greatest = svd.singular_values.max();
    let Some(u) = svd.u else { return own };
    let seen = (0..u.ncols()).filter(|&k| svd.singular_values[k] > 1e-10 * greatest);
    let basis = u.select_columns(&seen.collect::<Vec<_>>());
    &own - &basis * basis.tr_mul(&own)
}

pub(super) struct Seen {
    pub(super) rank: usize,
    pub(super) condition: f64,
    pub(super) covariance: SMatrix<f64, 10, 10>,
}

/// Rank, condition and covariance from the rows over σ.
pub(super) fn determined(
    arm: &DMatrix<f64>,
    unknowns: Unknowns,
    p: &Parameters,
) -> Result<Seen, CalibrationError> {
    let (rank, condition) = rank_and_condition(arm, unknowns);
    check_seen(arm, unknowns, p, 1.0)?;
    Ok(Seen {
        rank,
        condition,
        covariance: covariance(arm, unknowns, 1.0),
    })
}
