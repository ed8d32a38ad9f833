//! Weighted least squares with deviations that allow for correlated residuals, of the rows that no wrong sample
//! spoils.

use super::followed::understated;
use super::processing::System;
use super::spikes::without_spikes;
use crate::statistics::coverage_factor;
use fivebar_kinematics::five_bar::Joint;
use nalgebra::{DMatrix, DVector};

/// The solution of a system.
pub(super) struct Solution {
    pub(super) value: DVector<f64>,
    pub(super) sd: DVector<f64>,
    /// With this factor of its deviation on either side, a value's interval holds 95 %.
    pub(super) coverage_factor: f64,
    /// Root mean square of the residual of each joint in the rows that are used [N·m].
    pub(super) rms: [f64; 2],
    /// The share of each joint's rows that are left out.
    pub(super) left_out: [f64; 2],
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
pub(super) const LAGS: usize = 24;

/// What a lag counts of the correlation (Newey and West 1987).
pub(super) fn taper(lag: usize) -> f64 {
    1.0 - lag as f64 / (LAGS + 1) as f64
}

/// Solves a system with unknowns of these typical sizes; each joint is weighted by the deviation
/// of its residual. Rows that wrong samples spoil are left out, and the rest is solved again.
pub(super) fn solve(system: &System, scales: &DVector<f64>) -> Option<Solution> {
    let scaled = System {
        matrix: Joint::ALL.map(|joint| {
            let mut matrix = system.matrix[joint].clone();
            for (mut column, scale) in matrix.column_iter_mut().zip(scales.iter()) {
                column *= *scale;
            }
            matrix
        }),
        torque: system.torque.clone(),
    };
    let rows = scaled.torque[0].len();
    let mut used = [vec![true; rows], vec![true; rows]];
    let mut fit = Fit::of(&scaled, &used)?;
    // Few rounds suffice: what a spike hides are others near it.
    for _ in 0..4 {
        let next = Joint::ALL.map(|joint| {
            without_spikes(&(&scaled.torque[joint] - &scaled.matrix[joint] * &fit.value))
        });
        if next == used {
            break;
        }
        used = next;
        fit = Fit::of(&scaled, &used)?;
    }
    fit.solution(scales, &used)
}

/// The solution of a system in units of the unknowns' typical sizes.
struct Fit {
    /// With zeros in place of the rows that are not used: they count nothing, and keep the others at their times.
    system: System,
    /// The rows of each joint that are used.
    count: [usize; 2],
    gram: [DMatrix<f64>; 2],
    /// Of each joint, by the deviation of its residual.
    weight: [f64; 2],
    value: DVector<f64>,
    rms: [f64; 2],
}

impl Fit {
    fn of(system: &System, used: &[Vec<bool>; 2]) -> Option<Self> {
        let count = Joint::ALL.map(|joint| used[joint].iter().filter(|used| **used).count());
        if count.contains(&0) {
            return None;
        }
        let system = with_zeros(system, used);
        let scaled = &system.matrix;
        let gram = [scaled[0].tr_mul(&scaled[0]), scaled[1].tr_mul(&scaled[1])];
        let right = [
            scaled[0].tr_mul(&system.torque[0]),
            scaled[1].tr_mul(&system.torque[1]),
        ];
        let mut weight = [1.0; 2];
        let mut value = DVector::zeros(scaled[0].ncols());
        let mut rms = [0.0; 2];
        for _ in 0..3 {
            let normal = &gram[0] * weight[0] + &gram[1] * weight[1];
            value = normal
                .cholesky()?
                .solve(&(&right[0] * weight[0] + &right[1] * weight[1]));
            for joint in Joint::ALL {
                let residual = &system.torque[joint] - &scaled[joint] * &value;
                rms[joint] = (residual.norm_squared() / count[joint] as f64).sqrt();
                weight[joint] = 1.0 / (rms[joint] * rms[joint]).max(1e-18);
            }
        }
        Some(Self {
            system,
            count,
            gram,
            weight,
            value,
            rms,
        })
    }

    /// With deviations, in SI units.
    fn solution(&self, scales: &DVector<f64>, used: &[Vec<bool>; 2]) -> Option<Solution> {
        let (system, count, weight) = (&self.system, self.count, self.weight);
        let (scaled, gram) = (&system.matrix, &self.gram);
        let plain = (&gram[0] + &gram[1]).symmetric_eigen();
        let least = plain.eigenvalues.imin();
        let inverse = (&gram[0] * weight[0] + &gram[1] * weight[1])
            .cholesky()?
            .inverse();
        let scatter = scatter(system, &self.value, weight);
        let covariance = &inverse * scatter * &inverse;
        let residual = Joint::ALL.map(|joint| &system.torque[joint] - &scaled[joint] * &self.value);
        let gain = Joint::ALL.map(|joint| &inverse * scaled[joint].transpose() * weight[joint]);
        let factor = understated(scaled, &gain, &residual);
        let sd = DVector::from_fn(scales.len(), |i, _| {
            (factor[i] * covariance[(i, i)].max(0.0)).sqrt() * scales[i]
        });
        let share = Joint::ALL.map(|joint| {
            let torque = &system.torque[joint];
            let mean = torque.sum() / count[joint] as f64;
            let pairs = torque.iter().zip(&used[joint]);
            let kept = pairs.filter(|(_, used)| **used);
            let size: f64 = kept.map(|(x, _)| (x - mean) * (x - mean)).sum();
            self.rms[joint] / (size / count[joint] as f64).sqrt().max(1e-12)
        });
        let rows = count[0].min(count[1]) as f64;
        Some(Solution {
            value: self.value.component_mul(scales),
            sd,
            coverage_factor: coverage_factor(1.5 * rows / (LAGS + 1) as f64),
            rms: self.rms,
            left_out: count.map(|count| 1.0 - count as f64 / used[0].len() as f64),
            share,
            condition: (plain.eigenvalues.max() / plain.eigenvalues[least].max(1e-300)).sqrt(),
            weakest: plain.eigenvectors.column(least).abs(),
        })
    }
}

/// A system with zeros in place of the rows that are left out.
fn with_zeros(system: &System, used: &[Vec<bool>; 2]) -> System {
    let mut system = system.clone();
    for joint in Joint::ALL {
        for row in (0..used[joint].len()).filter(|&row| !used[joint][row]) {
            system.matrix[joint].row_mut(row).fill(0.0);
            system.torque[joint][row] = 0.0;
        }
    }
    system
}

/// Σ over lags of Σk w x_k r_k r_{k−lag} x_{k−lag}ᵀ w, the lags tapered to 0 (Newey and West 1987).
fn scatter(system: &System, value: &DVector<f64>, weight: [f64; 2]) -> DMatrix<f64> {
    let scaled = &system.matrix;
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
        let later = scores.rows(lag, rows - lag);
        let earlier = scores.rows(0, rows - lag);
        let product = later.tr_mul(&earlier);
        total += (&product + product.transpose()) * taper(lag);
    }
    total
}
