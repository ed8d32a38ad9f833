//! The closed loop of a joint behind a belt, and what it does after a step of its load.

use super::linear::{Linear, solve};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

type C = Complex<f64>;

/// Ticks of the step.
const STEP: usize = 600;

/// The closed loop over the states of plant and law.
pub(super) fn closed(plant: &Linear, law: &Linear) -> DMatrix<f64> {
    let (n, m) = (plant.a.nrows(), law.a.nrows());
    let mut matrix = DMatrix::zeros(n + m, n + m);
    let feedthrough = &plant.b * &law.d * &plant.c;
    matrix
        .view_mut((0, 0), (n, n))
        .copy_from(&(&plant.a + feedthrough));
    matrix
        .view_mut((0, n), (n, m))
        .copy_from(&(&plant.b * &law.c));
    matrix
        .view_mut((n, 0), (m, n))
        .copy_from(&(&law.b * &plant.c));
    matrix.view_mut((n, n), (m, m)).copy_from(&law.a);
    matrix
}

/// What a plant's joint does for a demanded torque, and its encoder and its joint for a load.
pub(super) fn yields(plant: &Linear, inertia: f64, period: f64, z: C) -> [C; 3] {
    let n = plant.a.nrows();
    let mut inputs = DMatrix::zeros(n, 2);
    inputs.set_column(0, &plant.b.column(0));
    inputs.set_column(1, &load(n, inertia, period));
    let states = solve(&plant.a, &inputs, z);
    let shown = (0..n).map(|i| states[(i, 1)] * plant.c[i]).sum();
    [states[(2, 0)], shown, states[(2, 1)]]
}

/// What a load of 1 N·m on the links adds to a plant's states in a tick.
fn load(states: usize, inertia: f64, period: f64) -> DVector<f64> {
    let mut load = DVector::zeros(states);
    load[2] = 0.5 * period * period / inertia;
    load[3] = period / inertia;
    load
}

/// The joint's angle after a step of its load, root mean square.
pub(super) fn step(plant: &Linear, law: &Linear, inertia: f64, period: f64) -> f64 {
    let matrix = closed(plant, law);
    let load = load(matrix.nrows(), inertia, period);
    let mut x = DVector::zeros(matrix.nrows());
    let mut next = x.clone();
    let mut sum = 0.0;
    let is_entry = |entry: &f64| *entry != 0.0;
    // Of each column, the entries from the first to the last that is not 0: the law reaches the plant in one row only.
    let columns: Vec<(usize, &[f64])> = matrix
        .as_slice()
        .chunks_exact(matrix.nrows())
        .map(|column| {
            let first = column.iter().position(is_entry).unwrap_or(0);
            let end = column.iter().rposition(is_entry).map_or(0, |last| last + 1);
            (first, &column[first..end.max(first)])
        })
        .collect();
    for _ in 0..STEP {
        // Matrix times state, by columns: nalgebra's own takes four times as long and has the same bits.
        next.fill(0.0);
        for (&(first, column), &x) in columns.iter().zip(x.iter()) {
            let next = &mut next.as_mut_slice()[first..];
            for (next, entry) in next.iter_mut().zip(column) {
                *next += entry * x;
            }
        }
        next += &load;
        std::mem::swap(&mut x, &mut next);
        sum += x[2] * x[2];
    }
    (sum / STEP as f64).sqrt()
}
