//! Sensitivities by automatic differentiation: for any model that is generic over its number.

use crate::Dual;
use fivebar_kinematics::Scalar;
use nalgebra::DMatrix;

/// Results as a function of primitives.
///
/// ```
/// use fivebar_design::accuracy::{DifferentiableModel, sensitivities};
/// use fivebar_kinematics::Scalar;
///
/// /// The hypotenuse of two sides [m].
/// struct Hypotenuse;
///
/// impl DifferentiableModel for Hypotenuse {
///     type Error = core::convert::Infallible;
///
///     fn evaluate<S: Scalar>(&self, sides: &[S]) -> Result<Vec<S>, Self::Error> {
///         Ok(vec![(sides[0] * sides[0] + sides[1] * sides[1]).sqrt()])
///     }
/// }
///
/// let by_sides = sensitivities(&Hypotenuse, &[0.3, 0.4])?;
/// assert!((by_sides[(0, 0)] - 0.6).abs() < 1e-15 && (by_sides[(0, 1)] - 0.8).abs() < 1e-15);
/// # Ok::<(), core::convert::Infallible>(())
/// ```
pub trait DifferentiableModel {
    /// The reason why there may be no results.
    type Error;

    /// The results at these values of the primitives.
    ///
    /// # Errors
    /// Where the model has no results.
    fn evaluate<S: Scalar>(&self, primitives: &[S]) -> Result<Vec<S>, Self::Error>;
}

/// T: the derivative of each result (row) by each primitive (column) at `values`, exact except
/// for rounding. The model is evaluated once in dual numbers for each primitive.
///
/// # Errors
/// As the model at these values.
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
