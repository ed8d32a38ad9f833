//! A fit that leaves out what contradicts the rest, and states deviations that hold.
//!
//! Residuals are in units of their stated deviation σ, in blocks of one or two rows: a distance, or
//! a point. Blocks of one kind have one scale s: their real deviation is s σ.
//!
//! 1. *Left out* is a block that the others contradict: of sound sets, at most one in a hundred
//!    loses a block ([`outliers`]).
//! 2. *Fit*: Huber's loss with its threshold at 1.5 s σ, of the blocks that are kept, until blocks and scales stay.
//! 3. *Scale* ([`scale`]): s = 1 as long as the sum of squares is one that σ would give, else from that sum.

mod linear;
mod outliers;
mod scale;

use crate::fit::{Loss, Rows, minimise};
use linear::Linear;
use nalgebra::DVector;
pub(crate) use scale::Scale;

/// Huber's threshold in deviations.
pub(crate) const THRESHOLD: f64 = 1.5;

/// Rows that belong to one measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Block {
    /// The first of its rows.
    pub(crate) first: usize,
    /// One row or two.
    pub(crate) size: usize,
    /// Its kind, from 0.
    pub(crate) kind: usize,
}

impl Block {
    pub(crate) fn rows(self) -> core::ops::Range<usize> {
        self.first..self.first + self.size
    }
}

/// A fit, what it leaves out, and the scale of each kind.
pub(crate) struct Settled {
    pub(crate) x: DVector<f64>,
    /// Whether a block is used.
    pub(crate) kept: Vec<bool>,
    pub(crate) scales: Vec<Scale>,
}

/// Fits blocks from the unknowns `start` of a robust fit of all rows.
pub(crate) fn settle(
    start: &DVector<f64>,
    rows: &dyn Fn(&DVector<f64>) -> Option<Rows>,
    blocks: &[Block],
) -> Option<Settled> {
    let kinds = blocks.iter().map(|block| block.kind + 1).max()?;
    let first = Linear::new(rows(start)?, blocks);
    let mut kept = outliers::without_outliers(&first, kinds);
    let mut x = start.clone();
    let mut scales = first.scales(&kept, kinds);
    // Few rounds suffice: the fits are near each other, so that blocks change sides at most once or twice.
    for _ in 0..8 {
        x = fitted(&x, rows, blocks, &kept, &scales)?;
        let here = Linear::new(rows(&x)?, blocks);
        let next = outliers::fixed_point(&here, kept.clone(), kinds);
        let settled = next == kept;
        let now = here.scales(&next, kinds);
        let close = |(a, b): (&Scale, &Scale)| (a.value / b.value - 1.0).abs() < 1e-6;
        let steady = scales.iter().zip(&now).all(close);
        (kept, scales) = (next, now);
        if settled && steady {
            break;
        }
    }
    Some(Settled { x, kept, scales })
}

/// The fit of the kept blocks by Huber's loss; rows that are left out count nothing.
fn fitted(
    start: &DVector<f64>,
    rows: &dyn Fn(&DVector<f64>) -> Option<Rows>,
    blocks: &[Block],
    kept: &[bool],
    scales: &[Scale],
) -> Option<DVector<f64>> {
    let weighted = |x: &DVector<f64>| {
        let (mut r, mut j) = rows(x)?;
        for (block, &kept) in blocks.iter().zip(kept) {
            let weight = if kept {
                1.0 / scales[block.kind].value
            } else {
                0.0
            };
            for row in block.rows() {
                r[row] *= weight;
                j.row_mut(row).scale_mut(weight);
            }
        }
        Some((r, j))
    };
    Some(minimise(start, &weighted, Loss::Huber(THRESHOLD))?.0)
}

/// The scale of each kind at a fit that leaves nothing out.
pub(crate) fn scales(rows: Rows, blocks: &[Block]) -> Vec<Scale> {
    let kinds = blocks.iter().map(|block| block.kind + 1).max().unwrap_or(0);
    Linear::new(rows, blocks).scales(&vec![true; blocks.len()], kinds)
}
