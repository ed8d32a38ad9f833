//! Weighted least squares with deviations that allow for correlated residuals.

use super::processing::System;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::{DMatrix, DVector};

/// The solution of a system.
pub(super) struct Solution {
    pub(super) value: DVector<f64>,
    pub(super) sd: DVector<f64>,
    /// Root mean square of the residual of each joint [N·m].
    pub(super) rms: [f64; 2],
    /// The same over that of the torque without its mean.
    pub(super) share: [f64; 2],
    /// Condition of the matrix with columns in typical units.
    pub(super) condition: f64,
    /// Share of each column in the least determined direction.
    pub(super) weakest: DVector<f64>,
}

/// Typical sizes of base parameters, friction and offsets: J 1e-3 kg·m², h 1e-2 kg·m, friction and offset 1e-2.
pub(super) fn scales(base: usize) -> DVector<f64> {
    DVector::from_fn(base + 6, |index, _| if index < 4 { 1e-3 } else { 1e-2 })
}

/// Lags of the residuals' correlation that the deviations allow for, in kept rows: 100 ms.
const LAGS: usize = 24;

/// Solves a system with unknowns of these typical sizes; each joint is weighted by the deviation
/// of its residual.
pub(super) fn solve(system: &System, scales: &DVector<f64>) -> Option<Solution> {
    let unknowns = scales.len();
    let scaled = Joint::ALL.map(|joint| {
        let mut matrix = system.matrix[joint].clone();
        for (mut column, scale) in matrix.column_iter_mut().zip(scales.iter()) {
            column *= *scale;
        }
        matrix
    });
    let gram = [scaled[0].tr_mul(&scaled[0]), scaled[1].tr_mul(&scaled[1])];
    let right = [
        scaled[0].tr_mul(&system.torque[0]),
        scaled[1].tr_mul(&system.torque[1]),
    ];
    let plain = (&gram[0] + &gram[1]).symmetric_eigen();
    let least = plain.eigenvalues.imin();
    let condition = (plain.eigenvalues.max() / plain.eigenvalues[least].max(1e-300)).sqrt();
    let weakest = plain.eigenvectors.column(least).abs();
    let mut weight = [1.0; 2];
    let mut value = DVector::zeros(unknowns);
    let mut rms = [0.0; 2];
    for _ in 0..3 {
        let normal = &gram[0] * weight[0] + &gram[1] * weight[1];
        value = normal
            .cholesky()?
            .solve(&(&right[0] * weight[0] + &right[1] * weight[1]));
        for joint in Joint::ALL {
            let residual = &system.torque[joint] - &scaled[joint] * &value;
            rms[joint] = (residual.norm_squared() / residual.len() as f64).sqrt();
            weight[joint] = 1.0 / (rms[joint] * rms[joint]).max(1e-18);
        }
    }
    let inverse = (&gram[0] * weight[0] + &gram[1] * weight[1])
        .cholesky()?
        .inverse();
    let scatter = scatter(system, &scaled, &value, weight);
    let covariance = &inverse * scatter * &inverse;
    let sd = DVector::from_fn(unknowns, |i, _| {
        covariance[(i, i)].max(0.0).sqrt() * scales[i]
    });
    let share = Joint::ALL.map(|joint| {
        let torque = &system.torque[joint];
        let mean = torque.mean();
        let size = torque.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
        rms[joint] / (size / torque.len() as f64).sqrt().max(1e-12)
    });
    Some(Solution {
        value: value.component_mul(scales),
        sd,
        rms,
        share,
        condition,
        weakest,
    })
}

/// Σ over lags of Σk w x_k r_k r_{k−lag} x_{k−lag}ᵀ w, the lags tapered to 0 (Newey and West 1987).
fn scatter(
    system: &System,
    scaled: &[DMatrix<f64>; 2],
    value: &DVector<f64>,
    weight: [f64; 2],
) -> DMatrix<f64> {
    let columns = value.len();
    let rows = scaled[0].nrows();
    let mut scores = DMatrix::zeros(rows, columns);
    for joint in 0..2 {
        let residual = &system.torque[joint] - &scaled[joint] * value;
        for row in 0..rows {
            let factor = weight[joint] * residual[row];
            for column in 0..columns {
                scores[(row, column)] += factor * scaled[joint][(row, column)];
            }
        }
    }
    let mut total = scores.tr_mul(&scores);
    for lag in 1..=LAGS.min(rows.saturating_sub(1)) {
        let taper = 1.0 - lag as f64 / (LAGS + 1) as f64;
        let later = scores.rows(lag, rows - lag);
        let earlier = scores.rows(0, rows - lag);
        let product = later.tr_mul(&earlier);
        total += (&product + product.transpose()) * taper;
    }
    total
}
