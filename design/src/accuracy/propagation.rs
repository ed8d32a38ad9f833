//! From the scatter of what is made to the scatter of what results, to first order:
//! Cov(R) = T Cov(primitives) Tᵀ, T collected over the *primitive* variables.
//!
//! Positions, velocities and accelerations answer to the same lengths and inputs, so they
//! are not independent of each other: treating δU, δU̇, δÜ as if they were is the error that
//! Shi 2005 sets out to avoid. T over the primitives cannot make it.

use nalgebra::{DMatrix, DVector};

/// Something with a scatter of its own, independent of every other primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct Primitive {
    /// Its name, for reports.
    pub name: String,
    /// Its mean, in its SI unit.
    pub mean: f64,
    /// Its standard deviation, in its SI unit.
    pub deviation: f64,
}

/// The scatter of some results.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Cov(R), in the products of the results' units.
    pub covariance: DMatrix<f64>,
    /// For each result (row) the variance that each primitive (column) brings in.
    pub contributions: DMatrix<f64>,
}

impl Scatter {
    /// Propagates through the sensitivities T, a row for each result and a column for
    /// each primitive.
    pub fn propagate(sensitivities: &DMatrix<f64>, primitives: &[Primitive]) -> Self {
        let deviations: Vec<f64> = primitives.iter().map(|p| p.deviation).collect();
        let scaled = DMatrix::from_fn(
            sensitivities.nrows(),
            sensitivities.ncols(),
            |row, column| sensitivities[(row, column)] * deviations[column],
        );
        Self {
            covariance: &scaled * scaled.transpose(),
            contributions: scaled.map(|x| x * x),
        }
    }

    /// The standard deviation of each result.
    pub fn deviations(&self) -> DVector<f64> {
        self.covariance.diagonal().map(f64::sqrt)
    }

    /// The share of a result's variance that each primitive brings in, 0…1.
    pub fn shares(&self, result: usize) -> Vec<f64> {
        let total = self.covariance[(result, result)];
        let row = self.contributions.row(result);
        row.iter()
            .map(|&part| if total > 0.0 { part / total } else { 0.0 })
            .collect()
    }

    /// The correlation of two results, −1…1; zero where one has no scatter.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        let product = self.covariance[(a, a)] * self.covariance[(b, b)];
        if product > 0.0 {
            self.covariance[(a, b)] / product.sqrt()
        } else {
            0.0
        }
    }
}
