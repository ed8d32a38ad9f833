//! How far measurements of one kind really scatter, in units of their stated deviation σ.
//!
//! With ν more rows than the unknowns take up, the residuals' sum of squares over σ² has the χ²
//! distribution with ν degrees of freedom if σ is right. Within the middle 90 % of that
//! distribution, σ stays as stated; beyond, on either side, s² = Σ r²/(ν σ²).
//!
//! The covariance of a fit by Huber's loss is v σ² (JᵀJ)⁻¹ with v = s² E ψ²/(E ψ′)² (Huber 1981,
//! chapter 7), ψ(r) = r clipped to ± 1.5 s: 1.037 s² of normal errors, and from the residuals
//! themselves where s is. Each residual is divided by √(1 − h) first, since the fit follows the
//! share h of it. With few rows for the unknowns, which of them are clipped is chance, and makes the estimate
//! scatter more: v has the factor K², K = 1 + (p/n) (1 − m)/m with m = E ψ′, for p unknowns of n rows (Huber 1981,
//! section 7.6).

use super::THRESHOLD;
use super::linear::Linear;
use crate::statistics::chi_square_beyond;

/// Tail of the χ² distribution beyond which the stated deviation is not believed, on each side.
const TAIL: f64 = 0.05;
/// E ψ²/(E ψ′)² of normal errors with the threshold 1.5: 0.7784/0.8664².
const NORMAL_VARIANCE: f64 = 1.037;
/// E ψ′ of normal errors with the threshold 1.5: their share within it.
const NORMAL_WITHIN: f64 = 0.8664;

/// The least scale: measurements without errors have residuals of rounding alone, which tell no deviation.
const LEAST: f64 = 1e-3;

/// The scale of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// s: the real deviation over the stated one.
    pub(crate) value: f64,
    /// v: the square of the deviation that the covariance is made with [σ²].
    pub(crate) variance: f64,
    /// Degrees of freedom with which s is known; infinite where σ is as stated.
    pub(crate) freedom: f64,
}

pub(super) fn scales(problem: &Linear<'_>, kept: &[bool], kinds: usize) -> Vec<Scale> {
    let stated = |followed: f64| Scale {
        value: 1.0,
        variance: NORMAL_VARIANCE * few_rows(followed, NORMAL_WITHIN),
        freedom: f64::INFINITY,
    };
    let Some(fit) = problem.fit(kept, &vec![1.0; kinds]) else {
        return vec![stated(0.0); kinds];
    };
    let of = |kind: usize| {
        let used = (0..kept.len()).filter(|&at| kept[at] && problem.blocks[at].kind == kind);
        // Residuals with the share of each that the fit does not follow.
        let mut rows = Vec::new();
        for at in used {
            let block = problem.blocks[at];
            let predicted = problem.predicted(&fit, kept, &vec![1.0; kinds], at);
            let free = predicted.redundancy / block.size as f64;
            rows.extend(block.rows().map(|row| (problem.residuals[row], free)));
        }
        let freedom: f64 = rows.iter().map(|(_, free)| free).sum();
        let squares: f64 = rows.iter().map(|(r, _)| r * r).sum();
        let followed = 1.0 - freedom / rows.len().max(1) as f64;
        let tail = chi_square_beyond(squares, freedom);
        if freedom < 1.0 || (TAIL..=1.0 - TAIL).contains(&tail) {
            return stated(followed);
        }
        let value = (squares / freedom).sqrt().max(LEAST);
        let limit = THRESHOLD * value;
        let (mut clipped, mut within) = (0.0, 0.0);
        for (r, free) in rows {
            let r = r / free.max(1e-3).sqrt();
            clipped += free * r.abs().min(limit).powi(2);
            within += if r.abs() < limit { free } else { 0.0 };
        }
        let few = few_rows(followed, within / freedom);
        let variance = clipped * freedom / (within * within).max(1e-3) * few;
        Scale {
            value,
            variance: variance.max(LEAST * LEAST),
            freedom,
        }
    };
    (0..kinds).map(of).collect()
}

/// K² where the fit follows this share p/n of the rows, and this share m of them is not clipped.
fn few_rows(followed: f64, within: f64) -> f64 {
    let within = within.clamp(0.1, 1.0);
    (1.0 + followed.clamp(0.0, 1.0) * (1.0 - within) / within).powi(2)
}
