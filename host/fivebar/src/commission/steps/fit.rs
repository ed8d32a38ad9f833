//! Linear least squares.

use nalgebra::{DMatrix, DVector};

/// The solution and its standard deviations.
pub(super) struct Fit {
    pub(super) values: Vec<f64>,
    pub(super) deviations: Vec<f64>,
}

/// Solves rows · x = rights; none if the rows do not determine x, or if there are fewer than
/// `per_unknown` for each unknown.
pub(super) fn least_squares(rows: &[Vec<f64>], rights: &[f64], per_unknown: usize) -> Option<Fit> {
    let width = rows.first()?.len();
    if rows.len() < per_unknown * width {
        return None;
    }
    let matrix = DMatrix::from_fn(rows.len(), width, |row, column| rows[row][column]);
    let right = DVector::from_column_slice(rights);
    let normal = matrix.transpose() * &matrix;
    let inverse = normal.cholesky()?.inverse();
    let values = &inverse * (matrix.transpose() * &right);
    let residual = (&matrix * &values - right).norm_squared();
    let variance = residual / (rows.len() - width) as f64;
    let deviations = (0..width)
        .map(|i| (variance * inverse[(i, i)]).sqrt())
        .collect();
    let values: Vec<f64> = values.iter().copied().collect();
    values
        .iter()
        .all(|value| value.is_finite())
        .then_some(Fit { values, deviations })
}

#[cfg(test)]
mod tests {
    use super::least_squares;

    #[test]
    fn finds_a_line_and_refuses_what_is_undetermined() {
        let rows: Vec<Vec<f64>> = (0..20).map(|x| vec![f64::from(x), 1.0]).collect();
        let rights: Vec<f64> = (0..20).map(|x| 3.0 * f64::from(x) - 2.0).collect();
        let fit = least_squares(&rows, &rights, 5).unwrap();
        assert!((fit.values[0] - 3.0).abs() < 1e-9 && (fit.values[1] + 2.0).abs() < 1e-9);
        assert!(fit.deviations[0] < 1e-9);
        let same: Vec<Vec<f64>> = (0..20).map(|_| vec![0.0, 1.0]).collect();
        assert!(least_squares(&rows, &rights, 11).is_none());
        assert!(least_squares(&same, &rights, 5).is_none());
    }
}
