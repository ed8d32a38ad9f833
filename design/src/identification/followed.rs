//! By how much residuals understate the deviations of what was fitted to them.
//!
//! A fit follows the noise most where its columns are: at the slow frequencies of the motion, of which a log of some
//! seconds has few. There the residuals keep less of the noise than elsewhere, and the scatter that is estimated
//! from them there is too small; its taper and a noise that is less at other frequencies take some more. Of stationary
//! noise with the residuals' correlation Ω, the fit β = G y has the covariance V = G Ω Gᵀ, and its residuals
//! r = (1 − X G) y have E[r rᵀ] = Ω − X C − Cᵀ Xᵀ + X V Xᵀ with C = G Ω. So what the estimate is to be, and what it is in
//! the mean, are both known.

use super::least_squares::{LAGS, taper};
use nalgebra::{DMatrix, DVector};

/// Greatest factor: of more the residuals say too little.
const MOST: f64 = 4.0;

/// The factors by which the variances of the unknowns are greater than those estimated from residuals. Of each joint:
/// the rows X, those of G that give β from them, and the residuals.
pub(super) fn understated(
    matrix: &[DMatrix<f64>; 2],
    gain: &[DMatrix<f64>; 2],
    residual: &[DVector<f64>; 2],
) -> DVector<f64> {
    let fit = Fit {
        across: [0, 1].map(|joint: usize| matrix[joint].transpose()),
        gain,
    };
    let lags = LAGS.min(residual[0].len().saturating_sub(1));
    let seen = [0, 1].map(|joint: usize| correlation(&residual[joint], lags));
    // The residuals have less of the noise's correlation, too: by as much as residuals of a noise like them would have.
    let of_residuals = fit.estimates(&seen).correlation;
    let noise = [0, 1].map(|joint: usize| {
        let pairs = seen[joint].iter().zip(&of_residuals[joint]);
        pairs.map(|(seen, less)| 2.0 * seen - less).collect()
    });
    let Estimates {
        covariance,
        estimated,
        ..
    } = fit.estimates(&noise);
    DVector::from_fn(estimated.len(), |index, _| {
        let factor = covariance[index] / estimated[index];
        // Of no noise at all there is nothing to compare.
        if factor.is_finite() && estimated[index] > 0.0 {
            factor.clamp(1.0, MOST)
        } else {
            1.0
        }
    })
}

/// Of each joint: Xᵀ and G.
struct Fit<'a> {
    across: [DMatrix<f64>; 2],
    gain: &'a [DMatrix<f64>; 2],
}

/// What becomes of a noise.
struct Estimates {
    /// The variances of the unknowns.
    covariance: DVector<f64>,
    /// Their mean estimates from residuals.
    estimated: DVector<f64>,
    /// The mean correlation of each joint's residuals, by lag.
    correlation: [Vec<f64>; 2],
}

impl Fit<'_> {
    /// For noise of this correlation of each joint, by lag.
    fn estimates(&self, noise: &[Vec<f64>; 2]) -> Estimates {
        let (across, gain) = (&self.across, self.gain);
        let (unknowns, rows) = gain[0].shape();
        // C, a column for each row of X.
        let followed = [0, 1].map(|joint: usize| {
            let mut product = &gain[joint] * noise[joint][0];
            for (lag, &size) in noise[joint].iter().enumerate().skip(1) {
                for row in lag..rows {
                    let (earlier, later) = (gain[joint].column(row - lag), gain[joint].column(row));
                    product.column_mut(row).axpy(size, &earlier, 1.0);
                    product.column_mut(row - lag).axpy(size, &later, 1.0);
                }
            }
            product
        });
        let covariance = &followed[0] * gain[0].transpose() + &followed[1] * gain[1].transpose();
        // C − ½ V Xᵀ =: D, so that E[r rᵀ] = Ω − X D − Dᵀ Xᵀ.
        let taken =
            [0, 1].map(|joint: usize| &followed[joint] - &covariance * &across[joint] * 0.5);
        let mut estimated = DVector::<f64>::zeros(unknowns);
        let mut correlation = [0, 1].map(|joint: usize| vec![0.0; noise[joint].len()]);
        for lag in 0..noise[0].len() {
            // Pairs of different rows count twice.
            let weight = taper(lag) * if lag == 0 { 1.0 } else { 2.0 };
            for later in lag..rows {
                let earlier = later - lag;
                for (one, other) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let own = if one == other { noise[one][lag] } else { 0.0 };
                    let expected = own
                        - across[one].column(later).dot(&taken[other].column(earlier))
                        - across[other].column(earlier).dot(&taken[one].column(later));
                    if one == other {
                        correlation[one][lag] += expected / rows as f64;
                    }
                    let (gains, others) = (gain[one].column(later), gain[other].column(earlier));
                    for index in 0..unknowns {
                        estimated[index] += weight * expected * gains[index] * others[index];
                    }
                }
            }
        }
        Estimates {
            covariance: covariance.diagonal(),
            estimated,
            correlation,
        }
    }
}

/// Covariance of a residual with itself some rows later.
fn correlation(residual: &DVector<f64>, lags: usize) -> Vec<f64> {
    let rows = residual.len();
    let at = |lag: usize| {
        residual
            .rows(lag, rows - lag)
            .dot(&residual.rows(0, rows - lag))
    };
    (0..=lags).map(|lag| at(lag) / rows as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::super::least_squares::solve;
    use super::super::processing::System;
    use crate::Noise;
    use nalgebra::{DMatrix, DVector};
    use std::f64::consts::TAU;

    /// Twelve of them in the slowest six frequencies of a log.
    #[test]
    fn the_deviations_of_slow_columns_in_smooth_noise_are_those_of_repetitions() {
        const ROWS: usize = 1000;
        const UNKNOWNS: usize = 12;
        let mut noise = Noise::new(61);
        let column = |row: usize, index: usize| {
            let turns = (1 + index / 2) as f64 * row as f64 / ROWS as f64;
            (TAU * (turns + 0.25 * (index % 2) as f64)).sin()
        };
        let matrix = [0, 1].map(|joint| {
            DMatrix::from_fn(ROWS, UNKNOWNS, |row, index| {
                if index % 4 < 2 || joint == 0 {
                    column(row, index)
                } else {
                    0.0
                }
            })
        });
        let mut smooth = || {
            let white: Vec<f64> = (0..ROWS + 4).map(|_| noise.normal()).collect();
            DVector::from_fn(ROWS, |row, _| white[row..row + 4].iter().sum::<f64>())
        };
        let repetitions = 60;
        let mut squares = 0.0;
        for _ in 0..repetitions {
            let torque = [smooth(), smooth()];
            let system = System {
                matrix: matrix.clone(),
                torque,
            };
            let found = solve(&system, &DVector::repeat(UNKNOWNS, 1.0)).unwrap();
            squares += found.value.component_div(&found.sd).norm_squared();
        }
        // The scatter is known to some 24 degrees of freedom, which adds 9 % in the mean.
        let mean = squares / f64::from(repetitions * UNKNOWNS as u32);
        assert!((0.95..1.25).contains(&mean), "{mean}");
    }
}
