//! The problem as linear near one fit: r + J δ, with what each block has to say of the others.

use super::Block;
use super::scale::Scale;
use crate::fit::{Rows, median};
use nalgebra::{DMatrix, DMatrixView, DVector};

/// Residuals [σ] and derivatives near a fit.
pub(super) struct Linear<'a> {
    pub(super) residuals: DVector<f64>,
    jacobian: DMatrix<f64>,
    /// Its transpose, in which the derivatives of one residual lie side by side.
    across: DMatrix<f64>,
    pub(super) blocks: &'a [Block],
    /// What each block gives to any fit: a search fits some thousand times.
    products: Vec<Products>,
}

/// The products of a block's derivatives, without those that are 0.
struct Products {
    /// The unknowns on which its residuals depend.
    seen: Vec<usize>,
    /// The lower triangle of JᵀJ, each with its place in the matrix column by column.
    normal: Vec<(usize, f64)>,
    /// Jᵀ r, each with its unknown.
    right: Vec<(usize, f64)>,
}

/// The least-squares fit of some blocks.
pub(super) struct Fit {
    /// Residuals of all blocks [σ].
    residuals: DVector<f64>,
    /// (JᵀWJ)⁻¹ of the blocks that are used.
    inverse: DMatrix<f64>,
}

/// Of a block, as predicted from the others that are used.
#[derive(Clone, Copy)]
pub(super) struct Prediction {
    /// eᵀ V⁻¹ e of its residual e, V being what it would scatter by with s = 1 [σ²]; none where
    /// nothing else determines it.
    pub(super) square: f64,
    /// The part of its rows that the fit does not follow: its size less its leverage.
    pub(super) redundancy: f64,
}

impl<'a> Linear<'a> {
    pub(super) fn new((residuals, mut jacobian): Rows, blocks: &'a [Block]) -> Self {
        // Columns of one size.
        for mut column in jacobian.column_iter_mut() {
            column /= column.norm().max(f64::MIN_POSITIVE);
        }
        let across = jacobian.transpose();
        let products = blocks
            .iter()
            .map(|block| Products::of(block, &across, &residuals))
            .collect();
        Self {
            residuals,
            across,
            jacobian,
            blocks,
            products,
        }
    }

    pub(super) fn unknowns(&self) -> usize {
        self.jacobian.ncols()
    }

    /// The least-squares fit of the blocks that are kept, weighted by the scales of their kinds.
    pub(super) fn fit(&self, kept: &[bool], scales: &[f64]) -> Option<Fit> {
        let unknowns = self.unknowns();
        let mut normal = DMatrix::<f64>::zeros(unknowns, unknowns);
        let mut right = DVector::zeros(unknowns);
        let blocks = self.blocks.iter().zip(&self.products).zip(kept);
        for ((block, products), _) in blocks.filter(|(_, kept)| **kept) {
            let weight = scales[block.kind].powi(-2);
            let entries = normal.as_mut_slice();
            for &(place, product) in &products.normal {
                entries[place] += weight * product;
            }
            for &(unknown, product) in &products.right {
                right[unknown] += -weight * product;
            }
        }
        // What the blocks do not determine stays as it is.
        let ridge = 1e-12 * normal.trace().max(f64::MIN_POSITIVE);
        for i in 0..unknowns {
            normal[(i, i)] += ridge;
        }
        let factor = normal.cholesky()?;
        let step = factor.solve(&right);
        Some(Fit {
            residuals: &self.residuals + &self.jacobian * step,
            inverse: factor.inverse(),
        })
    }

    /// Mean square of a block's residual after a fit [σ²].
    pub(super) fn mean_square(&self, fit: &Fit, block: usize) -> f64 {
        let block = self.blocks[block];
        let rows = fit.residuals.rows(block.first, block.size);
        rows.norm_squared() / block.size as f64
    }

    /// A block as predicted from the others, whether it is in the fit or left out.
    pub(super) fn predicted(
        &self,
        fit: &Fit,
        kept: &[bool],
        scales: &[f64],
        at: usize,
    ) -> Prediction {
        let block = self.blocks[at];
        let rows = self.across.columns(block.first, block.size);
        // J (JᵀWJ)⁻¹ Jᵀ W of the block, without the unknowns that it does not see.
        let seen = &self.products[at].seen;
        let mut hat = DMatrix::zeros(block.size, block.size);
        for &column in seen {
            for row in 0..block.size {
                let product = sum(seen
                    .iter()
                    .map(|&of| rows[(of, row)] * fit.inverse[(of, column)]));
                for other in 0..block.size {
                    hat[(row, other)] += product * rows[(column, other)];
                }
            }
        }
        hat *= scales[block.kind].powi(-2);
        let sign = if kept[at] { -1.0 } else { 1.0 };
        let scatter = DMatrix::identity(block.size, block.size) + &hat * sign;
        let residual = fit.residuals.rows(block.first, block.size).into_owned();
        // A block that alone determines something is predicted by nothing.
        let inverse = (scatter.determinant() > 1e-6)
            .then(|| scatter.try_inverse())
            .flatten();
        let square = inverse.map_or(0.0, |inverse| residual.dot(&(inverse * &residual)));
        Prediction {
            square,
            redundancy: block.size as f64 - hat.trace(),
        }
    }

    /// Scales from the middle of the residuals of each kind, which half of the blocks cannot spoil.
    pub(super) fn middle_scales(&self, kinds: usize) -> Vec<f64> {
        let share = self.unknowns() as f64 / self.residuals.len() as f64;
        let of = |kind: usize| {
            let own = self.blocks.iter().filter(|block| block.kind == kind);
            let sizes = own.map(|block| {
                // Medians of χ² with one and with two degrees of freedom.
                let usual = if block.size == 1 { 0.455 } else { 1.386 };
                self.residuals.rows(block.first, block.size).norm_squared() / usual
            });
            let square = median(sizes).unwrap_or(1.0) / (1.0 - share).max(0.1);
            square.sqrt().max(1e-3)
        };
        (0..kinds).map(of).collect()
    }

    /// The scale of each kind after a fit by Huber's loss.
    pub(super) fn scales(&self, kept: &[bool], kinds: usize) -> Vec<Scale> {
        super::scale::scales(self, kept, kinds)
    }
}

impl Products {
    /// Of this block. A block has few residuals, each of few unknowns: written out, because nalgebra's products of such a
    /// block take many times as long and have the same bits.
    fn of(block: &Block, across: &DMatrix<f64>, residuals: &DVector<f64>) -> Self {
        let unknowns = across.nrows();
        let rows = across.columns(block.first, block.size);
        let residuals = residuals.rows(block.first, block.size);
        let mut products = Self {
            seen: Vec::new(),
            normal: Vec::new(),
            right: Vec::new(),
        };
        for column in (0..unknowns).filter(|&column| is_seen(&rows, column)) {
            products.seen.push(column);
            for row in column..unknowns {
                let product = sum((0..block.size).map(|of| rows[(row, of)] * rows[(column, of)]));
                if product != 0.0 {
                    products.normal.push((column * unknowns + row, product));
                }
            }
            let product = sum((0..block.size).map(|of| rows[(column, of)] * residuals[of]));
            if product != 0.0 {
                products.right.push((column, product));
            }
        }
        products
    }
}

/// Whether any residual of these depends on this unknown.
fn is_seen(rows: &DMatrixView<'_, f64>, unknown: usize) -> bool {
    rows.row(unknown)
        .iter()
        .any(|&derivative| derivative != 0.0)
}

/// The sum from the first to the last.
fn sum(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value)
}

#[cfg(test)]
mod tests;
