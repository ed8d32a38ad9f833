//! Which blocks the others contradict.
//!
//! A block is predicted from the others that are kept: with its residual e and what e would
//! scatter by, s² V, the square eᵀV⁻¹e/s² is one of Hotelling's, and exceeds a bound with a known
//! probability. Each of N blocks is judged at 0.01/N (Bonferroni), so that of sound sets at most
//! one in a hundred loses a block. s is that of the other blocks of its kind, the stated deviation
//! counting as two more rows: where there are many rows, a plate three times as bad as stated
//! loses no block, and where there are few, the statement decides.
//!
//! Wrong blocks hide each other, and above all those that the fit follows. So the search starts
//! at the half of the blocks that agrees best (least trimmed squares, Rousseeuw and Van Driessen
//! 1999), takes in the others in the order in which they agree with those before, and looks from
//! the end for the last that is contradicted (Rosner 1983).

use super::linear::{Fit, Linear};
use crate::Noise;
use crate::statistics::beyond;

/// The share of sound sets that may lose a block.
const FALSE_ALARMS: f64 = 0.01;
/// As many rows the stated deviation counts as.
const STATED: f64 = 2.0;
/// Random samples at which the search for the best half starts.
const SAMPLES: usize = 60;

/// The blocks that the others do not contradict.
pub(super) fn without_outliers(problem: &Linear<'_>, kinds: usize) -> Vec<bool> {
    let count = problem.blocks.len();
    let scales = problem.middle_scales(kinds);
    let all = vec![true; count];
    let Some(half) = best_half(problem, &scales) else {
        return all;
    };
    let order = order(problem, &half, &scales);
    let mut kept = all;
    let mut found = kept.clone();
    for (left_out, &at) in order.iter().rev().enumerate() {
        let Some(state) = State::of(problem, &kept, kinds) else {
            break;
        };
        if state.tail(problem, &kept, at) < FALSE_ALARMS / (count - left_out) as f64 {
            found.clone_from(&kept);
            found[at] = false;
        }
        kept[at] = false;
    }
    fixed_point(problem, found, kinds)
}

/// Leaves blocks out and takes them in until each is as the others have it.
pub(super) fn fixed_point(problem: &Linear<'_>, mut kept: Vec<bool>, kinds: usize) -> Vec<bool> {
    let count = kept.len();
    for _ in 0..count {
        let Some(state) = State::of(problem, &kept, kinds) else {
            break;
        };
        let tails: Vec<f64> = (0..count)
            .map(|at| state.tail(problem, &kept, at))
            .collect();
        let bound = FALSE_ALARMS / count as f64;
        // The worst alone, because it spoils what is said of the others.
        let worst = (0..count)
            .filter(|&at| kept[at])
            .min_by(|&a, &b| tails[a].total_cmp(&tails[b]));
        let back = (0..count).find(|&at| !kept[at] && tails[at] >= bound);
        match (worst.filter(|&at| tails[at] < bound), back) {
            (Some(at), _) => kept[at] = false,
            (None, Some(at)) => kept[at] = true,
            (None, None) => break,
        }
    }
    kept
}

/// A fit, and what its residuals say of each kind.
struct State {
    fit: Fit,
    scales: Vec<f64>,
    /// Sum of squares [σ²] and degrees of freedom of each kind.
    sums: Vec<[f64; 2]>,
}

impl State {
    fn of(problem: &Linear<'_>, kept: &[bool], kinds: usize) -> Option<Self> {
        let mut scales = vec![1.0; kinds];
        // With one kind, its scale changes nothing.
        for _ in 0..if kinds == 1 { 1 } else { 4 } {
            let sums = sums(problem, &problem.fit(kept, &scales)?, kept, &scales);
            scales = sums.iter().map(|sum| pooled(*sum).sqrt()).collect();
        }
        let fit = problem.fit(kept, &scales)?;
        let sums = sums(problem, &fit, kept, &scales);
        Some(Self { fit, scales, sums })
    }

    /// The probability that a sound block would lie farther from where the others have it.
    fn tail(&self, problem: &Linear<'_>, kept: &[bool], at: usize) -> f64 {
        let block = problem.blocks[at];
        let own = problem.predicted(&self.fit, kept, &self.scales, at);
        let [squares, freedom] = self.sums[block.kind];
        let others = if kept[at] {
            [squares - own.square, freedom - block.size as f64]
        } else {
            [squares, freedom]
        };
        let [squares, freedom] = others.map(|value| value.max(0.0));
        beyond(
            own.square / pooled([squares, freedom]),
            block.size,
            STATED + freedom,
        )
    }
}

/// s² [σ²], the stated deviation counting as some rows.
fn pooled([squares, freedom]: [f64; 2]) -> f64 {
    (STATED + squares) / (STATED + freedom)
}

fn sums(problem: &Linear<'_>, fit: &Fit, kept: &[bool], scales: &[f64]) -> Vec<[f64; 2]> {
    let mut sums = vec![[0.0; 2]; scales.len()];
    for at in (0..kept.len()).filter(|&at| kept[at]) {
        let block = problem.blocks[at];
        let [squares, freedom] = &mut sums[block.kind];
        *squares += problem.mean_square(fit, at) * block.size as f64;
        *freedom += problem.predicted(fit, kept, scales, at).redundancy;
    }
    sums
}

/// How many blocks must agree: a little more than half, so that they determine the unknowns.
fn majority(problem: &Linear<'_>) -> usize {
    let count = problem.blocks.len();
    (count + needed(problem) + 1).div_ceil(2).min(count)
}

/// The fewest blocks that determine the unknowns.
fn needed(problem: &Linear<'_>) -> usize {
    let (rows, count) = (problem.residuals.len(), problem.blocks.len());
    (problem.unknowns() * count).div_ceil(rows)
}

/// The majority with the least sum of squares; none if there are too few blocks to choose.
fn best_half(problem: &Linear<'_>, scales: &[f64]) -> Option<Vec<bool>> {
    let count = problem.blocks.len();
    let majority = majority(problem);
    if majority >= count {
        return None;
    }
    let mut noise = Noise::new(1);
    let mut sample = || {
        let mut order: Vec<usize> = (0..count).collect();
        for i in 0..(needed(problem) + 1).min(count) {
            let other = i + (noise.uniform() * (count - i) as f64) as usize;
            order.swap(i, other);
        }
        let mut kept = vec![false; count];
        for &at in &order[..(needed(problem) + 1).min(count)] {
            kept[at] = true;
        }
        kept
    };
    let steps = |kept: Vec<bool>, rounds: usize| {
        let mut state = (f64::INFINITY, kept);
        for _ in 0..rounds {
            let Some(next) = concentrated(problem, &state.1, scales, majority) else {
                break;
            };
            if next.0 >= state.0 {
                break;
            }
            state = next;
        }
        state
    };
    let mut starts: Vec<_> = (0..SAMPLES).map(|_| steps(sample(), 2)).collect();
    starts.push(steps(vec![true; count], 2));
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let finished = starts.into_iter().take(6).map(|(_, kept)| steps(kept, 20));
    let best = finished.min_by(|a, b| a.0.total_cmp(&b.0))?;
    best.0.is_finite().then_some(best.1)
}

/// The blocks nearest to a fit of some, and the sum of their squares.
fn concentrated(
    problem: &Linear<'_>,
    kept: &[bool],
    scales: &[f64],
    majority: usize,
) -> Option<(f64, Vec<bool>)> {
    let fit = problem.fit(kept, scales)?;
    let distance =
        |at: usize| problem.mean_square(&fit, at) / scales[problem.blocks[at].kind].powi(2);
    let mut order: Vec<(f64, usize)> = (0..kept.len()).map(|at| (distance(at), at)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut nearest = vec![false; kept.len()];
    let mut sum = 0.0;
    for &(distance, at) in &order[..majority] {
        nearest[at] = true;
        sum += distance;
    }
    Some((sum, nearest))
}

/// The other blocks in the order in which they agree with those before.
fn order(problem: &Linear<'_>, half: &[bool], scales: &[f64]) -> Vec<usize> {
    let mut kept = half.to_vec();
    let mut order = Vec::new();
    while let Some(fit) = problem.fit(&kept, scales) {
        let distance = |at: usize| {
            let square = problem.predicted(&fit, &kept, scales, at).square;
            square / scales[problem.blocks[at].kind].powi(2) / problem.blocks[at].size as f64
        };
        let others = (0..kept.len()).filter(|&at| !kept[at]);
        let Some(next) = others.min_by(|&a, &b| distance(a).total_cmp(&distance(b))) else {
            break;
        };
        kept[next] = true;
        order.push(next);
    }
    order
}
