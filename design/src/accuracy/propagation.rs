//! The scatter of results from the scatter of the primitives (lengths, inputs), to first order:
//! Cov(R) = T Cov(primitives) Tᵀ, T collected over the *primitive* variables.
//!
//! Positions, velocities and accelerations depend on the same lengths and inputs, so δU, δU̇
//! and δÜ are correlated. Treating them as independent is the error that Shi 2005 avoids; with
//! T over the primitives it does not arise.

use nalgebra::{DMatrix, DVector};

/// A quantity with a scatter that is independent of all other primitives.
#[derive(Clone, Debug, PartialEq)]
pub struct Primitive {
    /// Its name, for reports.
    pub name: String,
    /// Its mean, in its SI unit.
    pub mean: f64,
    /// Its standard deviation, in its SI unit.
    pub deviation: f64,
}

/// The scatter of results.
///
/// ```
/// use fivebar_design::accuracy::{Primitive, Scatter};
/// use nalgebra::DMatrix;
///
/// // A sum of two lengths [m] with standard deviations of 30 µm and 40 µm.
/// let length = |mean, deviation| Primitive { name: "length".into(), mean, deviation };
/// let lengths = [length(0.10, 30e-6), length(0.16, 40e-6)];
/// let scatter = Scatter::propagate(&DMatrix::from_row_slice(1, 2, &[1.0, 1.0]), &lengths);
/// assert!((scatter.deviations()[0] - 50e-6).abs() < 1e-18);
/// assert!((scatter.shares(0)[0] - 0.36).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Cov(R), in the products of the results' units.
    pub covariance: DMatrix<f64>,
    /// For each result (row) the variance that each primitive (column) contributes.
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

    /// The share of each primitive in the variance of a result, 0…1.
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
