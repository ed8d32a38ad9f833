//! Levenberg–Marquardt on rows that are re-weighted for Huber's loss.

use nalgebra::{DMatrix, DVector};

/// Residuals, their derivatives by the unknowns.
pub(crate) type Rows = (DVector<f64>, DMatrix<f64>);

/// The sum of squares, or Huber's loss with its threshold [the residuals' unit].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Loss {
    Squares,
    Huber(f64),
}

impl Loss {
    /// Of one residual: r², or 2 f |r| − f² beyond the threshold f.
    fn of(self, r: f64) -> f64 {
        match self {
            Self::Huber(f) if r.abs() > f => f * (2.0 * r.abs() - f),
            _ => r * r,
        }
    }

    /// The weight of its row: w = min(1, f/|r|).
    fn weight(self, r: f64) -> f64 {
        match self {
            Self::Huber(f) if r.abs() > f => f / r.abs(),
            _ => 1.0,
        }
    }

    pub(crate) fn total(self, residuals: &DVector<f64>) -> f64 {
        residuals.iter().map(|&r| self.of(r)).sum()
    }
}

/// The upper median; none without values.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The unknowns with the least loss near `start`, and that loss. Without residuals at the start
/// there is none.
pub(crate) fn minimise(
    start: &DVector<f64>,
    rows: &dyn Fn(&DVector<f64>) -> Option<Rows>,
    loss: Loss,
) -> Option<(DVector<f64>, f64)> {
    let mut p = start.clone();
    let (mut r, mut j) = rows(&p)?;
    let mut cost = loss.total(&r);
    let mut damping = 1e-3;
    for _ in 0..400 {
        // (JᵀWJ + λ diag JᵀWJ) δ = −JᵀW r.
        let mut weighted = j.clone();
        for (mut row, &r) in weighted.row_iter_mut().zip(r.iter()) {
            row *= loss.weight(r);
        }
        let gradient = weighted.tr_mul(&r);
        let normal = weighted.tr_mul(&j);
        let mut damped = normal.clone();
        for i in 0..damped.nrows() {
            damped[(i, i)] += damping * normal[(i, i)].max(1e-12);
        }
        let step = damped.cholesky().map(|factor| factor.solve(&-&gradient));
        let tried = step.as_ref().and_then(|step| {
            let next = &p + step;
            let (r, j) = rows(&next)?;
            let lower = loss.total(&r);
            (lower <= cost).then_some((next, r, j, lower))
        });
        match tried {
            Some((next, next_r, next_j, lower)) => {
                let moved = step.map_or(0.0, |step| step.norm());
                (p, r, j) = (next, next_r, next_j);
                cost = lower;
                damping = (0.2 * damping).max(1e-12);
                if moved < 1e-13 {
                    break;
                }
            }
            None => {
                damping = if damping < 1e-6 { 1e-3 } else { 5.0 * damping };
                if damping > 1e9 {
                    break;
                }
            }
        }
    }
    Some((p, cost))
}
