//! The exponential of a square matrix.

use nalgebra::DMatrix;

/// Norm at which the series needs [`TERMS`] terms.
const SMALL: f64 = 0.5;
/// Terms after the identity: 0.5¹⁵/15! = 2e-17.
const TERMS: u32 = 15;

/// e^M = (e^(M/2ˢ))^(2ˢ), the inner one by its power series: scaling and squaring.
///
/// Source: C. Moler, C. Van Loan, Nineteen dubious ways to compute the exponential of a matrix,
/// SIAM Review 45 (2003), method 3.
pub(crate) fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    // The greatest sum of a column's absolute values. Doublings of a value that is not finite
    // would never end.
    let norm = (0..n)
        .map(|column| matrix.column(column).abs().sum())
        .fold(0.0, f64::max);
    if !norm.is_finite() {
        return DMatrix::repeat(n, n, f64::NAN);
    }
    let halvings = (norm / SMALL).log2().ceil().max(0.0) as i32;
    let scaled = matrix * 0.5_f64.powi(halvings);
    let mut term = DMatrix::identity(n, n);
    let mut sum = term.clone();
    for k in 1..=TERMS {
        term = &term * &scaled / f64::from(k);
        sum += &term;
    }
    for _ in 0..halvings {
        sum = &sum * &sum;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::exponential;
    use nalgebra::DMatrix;

    fn square(n: usize, rows: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(n, n, rows)
    }

    #[test]
    fn a_turn_a_decay_and_a_chain_of_integrators_have_their_closed_forms() {
        let near = |a: DMatrix<f64>, b: DMatrix<f64>| {
            let scale = b.amax().max(1.0);
            assert!((a - &b).amax() <= 1e-13 * scale, "not {b}");
        };
        for angle in [0.0, 1e-9, 0.3, 2.0, 7.0] {
            let (sin, cos) = f64::sin_cos(angle);
            let turn = square(2, &[0.0, -angle, angle, 0.0]);
            near(exponential(&turn), square(2, &[cos, -sin, sin, cos]));
        }
        let decay = square(2, &[-40.0, 0.0, 0.0, 3.0]);
        near(
            exponential(&decay),
            square(2, &[f64::exp(-40.0), 0.0, 0.0, f64::exp(3.0)]),
        );
        let chain = square(3, &[0.0, 9.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0]);
        near(
            exponential(&chain),
            square(3, &[1.0, 9.0, 40.5, 0.0, 1.0, 9.0, 0.0, 0.0, 1.0]),
        );
        assert!(
            exponential(&square(1, &[f64::INFINITY]))
                .iter()
                .all(|x| x.is_nan())
        );
    }
}
