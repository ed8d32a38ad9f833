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
///
/// By Gauss's elimination with the greatest pivot of each column, within one buffer: the search of a belt's gains does it
/// some hundred thousand times. nalgebra's own makes the same operations in the same order, in three times the time.
pub(super) fn solve(a: &DMatrix<f64>, b: &DMatrix<f64>, z: C) -> DMatrix<C> {
    let n = a.nrows();
    let mut x = b.map(|x| C::new(x, 0.0));
    // By columns.
    let mut m: Vec<C> = a.iter().map(|&entry| C::new(-entry, 0.0)).collect();
    for diagonal in m.iter_mut().step_by(n + 1) {
        *diagonal += z;
    }
    for i in 0..n {
        let (done, right) = m.split_at_mut((i + 1) * n);
        let (before, column) = done.split_at_mut(i * n);
        let size = |row: usize| column[row].l1_norm();
        let pivot = (i + 1..n).fold(
            i,
            |most, row| if size(row) > size(most) { row } else { most },
        );
        if column[pivot] == C::new(0.0, 0.0) {
            return DMatrix::from_element(n, b.ncols(), C::new(f64::NAN, 0.0));
        }
        if pivot != i {
            x.swap_rows(i, pivot);
            column.swap(i, pivot);
            for other in before.chunks_exact_mut(n).chain(right.chunks_exact_mut(n)) {
                other.swap(i, pivot);
            }
        }
        let per_pivot = C::new(1.0, 0.0) / column[i];
        for factor in &mut column[i + 1..] {
            *factor *= per_pivot;
        }
        for other in right.chunks_exact_mut(n) {
            let (above, below) = other.split_at_mut(i + 1);
            less(below, above[i], &column[i + 1..]);
        }
    }
    for x in x.as_mut_slice().chunks_exact_mut(n) {
        for i in 0..n {
            let (above, below) = x.split_at_mut(i + 1);
            less(below, above[i], &m[i * n + i + 1..(i + 1) * n]);
        }
        for i in (0..n).rev() {
            let (above, below) = x.split_at_mut(i);
            below[0] /= m[i * n + i];
            less(above, below[0], &m[i * n..i * n + i]);
        }
    }
    x
}

/// y ← y − c x. Many c are 0 where the systems are sparse.
#[inline]
fn less(y: &mut [C], c: C, x: &[C]) {
    if c == C::new(0.0, 0.0) {
        return;
    }
    for (y, x) in y.iter_mut().zip(x) {
        *y += -c * x;
    }
}

#[cfg(test)]
mod tests {
    use super::{C, solve};
    use crate::Noise;
    use nalgebra::DMatrix;

    #[test]
    fn elimination_is_that_of_nalgebra_to_the_last_bit_and_a_pole_gives_no_numbers() {
        let mut noise = Noise::new(1);
        for (n, full) in [(1, 1.0), (2, 1.0), (7, 1.0), (7, 0.3), (15, 0.5)] {
            let a = DMatrix::from_fn(n, n, |_, _| {
                let entry = noise.uniform() - 0.5;
                if noise.uniform() < full { entry } else { 0.0 }
            });
            let b = DMatrix::from_fn(n, 2, |_, _| noise.uniform() - 0.5);
            let z = C::from_polar(1.0, 3.0 * noise.uniform());
            let resolvent = DMatrix::from_fn(n, n, |i, j| {
                C::new(-a[(i, j)], 0.0) + if i == j { z } else { C::new(0.0, 0.0) }
            });
            let expected = resolvent.lu().solve(&b.map(|x| C::new(x, 0.0)));
            assert_eq!(solve(&a, &b, z), expected.unwrap(), "{n} states");
        }
        let a = DMatrix::from_diagonal_element(3, 3, 0.5);
        let at_pole = solve(&a, &DMatrix::from_element(3, 1, 1.0), C::new(0.5, 0.0));
        assert!(at_pole.iter().all(|x| x.re.is_nan()));
    }
}
