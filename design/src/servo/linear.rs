//! Linear systems in ticks.

use nalgebra::DMatrix;
use num_complex::Complex;

type C = Complex<f64>;

/// x ← A x + B u, y = C x + D u.
#[derive(Clone, Debug)]
pub(super) struct Linear {
    pub(super) a: DMatrix<f64>,
    pub(super) b: DMatrix<f64>,
    pub(super) c: DMatrix<f64>,
    pub(super) d: DMatrix<f64>,
}

impl Linear {
    /// The system whose `step` gives the next states and the outputs for states and inputs: found by asking it with
    /// one of them at a time.
    pub(super) fn asked(
        [states, inputs, outputs]: [usize; 3],
        step: impl Fn(&[f64], &[f64]) -> (Vec<f64>, Vec<f64>),
    ) -> Self {
        let mut system = Self {
            a: DMatrix::zeros(states, states),
            b: DMatrix::zeros(states, inputs),
            c: DMatrix::zeros(outputs, states),
            d: DMatrix::zeros(outputs, inputs),
        };
        let (mut x, mut u) = (vec![0.0; states], vec![0.0; inputs]);
        for column in 0..states {
            x[column] = 1.0;
            let (next, output) = step(&x, &u);
            system.a.column_mut(column).copy_from_slice(&next);
            system.c.column_mut(column).copy_from_slice(&output);
            x[column] = 0.0;
        }
        for column in 0..inputs {
            u[column] = 1.0;
            let (next, output) = step(&x, &u);
            system.b.column_mut(column).copy_from_slice(&next);
            system.d.column_mut(column).copy_from_slice(&output);
            u[column] = 0.0;
        }
        system
    }

    /// C (z − A)⁻¹ B + D.
    pub(super) fn response(&self, z: C) -> DMatrix<C> {
        let states = solve(&self.a, &self.b, z);
        DMatrix::from_fn(self.d.nrows(), self.d.ncols(), |row, column| {
            let terms = states.column(column);
            let sum: C = self
                .c
                .row(row)
                .iter()
                .zip(terms.iter())
                .map(|(&c, x)| x * c)
                .sum();
            sum + self.d[(row, column)]
        })
    }
}

/// (z − A)⁻¹ B; not numbers where z is a pole.
pub(super) fn solve(a: &DMatrix<f64>, b: &DMatrix<f64>, z: C) -> DMatrix<C> {
    let n = a.nrows();
    let resolvent = DMatrix::from_fn(n, n, |i, j| {
        C::new(-a[(i, j)], 0.0) + if i == j { z } else { C::new(0.0, 0.0) }
    });
    let b = b.map(|x| C::new(x, 0.0));
    let nan = || DMatrix::from_element(n, b.ncols(), C::new(f64::NAN, 0.0));
    resolvent.lu().solve(&b).unwrap_or_else(nan)
}
