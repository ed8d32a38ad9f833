//! Sensitivities by automatic differentiation: any model that is generic over its number.

use crate::Dual;
use fivebar_kinematics::Scalar;
use nalgebra::DMatrix;

/// Results as a function of primitives.
pub trait DifferentiableModel {
    /// Why there may be no results.
    type Error;

    /// The results at these values of the primitives.
    ///
    /// # Errors
    /// Where the model has no answer.
    fn evaluate<S: Scalar>(&self, primitives: &[S]) -> Result<Vec<S>, Self::Error>;
}

/// T: the derivative of each result (row) by each primitive (column) at `values`, exact to
/// rounding, by one pass of dual numbers a primitive.
///
/// # Errors
/// Whatever the model says at these values.
pub fn sensitivities<R: DifferentiableModel>(
    model: &R,
    values: &[f64],
) -> Result<DMatrix<f64>, R::Error> {
    let mut point: Vec<Dual> = values.iter().map(|&value| Dual::constant(value)).collect();
    let mut columns = Vec::with_capacity(values.len());
    for index in 0..point.len() {
        point[index] = Dual::variable(values[index]);
        columns.push(model.evaluate(&point)?);
        point[index] = Dual::constant(values[index]);
    }
    let rows = columns.first().map_or(0, Vec::len);
    Ok(DMatrix::from_fn(rows, columns.len(), |row, column| {
        columns[column][row].derivative()
    }))
}
