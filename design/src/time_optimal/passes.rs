//! TOPP-RA (Pham & Pham 2018) in closed form: the greatest x = ṡ² that can still stop, backward,
//! and the greatest acceleration from rest, forward.
//!
//! On a cell of width w, u is constant and x⁺ = x + 2 w u. Each row is a [`Strip`], and the
//! neighbour's bound 0 ≤ x⁺ ≤ K⁺ is one, too: β = 1/(2w), lo = 0, hi = K⁺/(2w).

use super::strip::{CHANGE, Row, Strip};

/// A path in cells, with the rows at their middles.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// w of each cell.
    pub(super) width: Vec<f64>,
    /// The greatest x at each node.
    pub(super) ceiling: Vec<f64>,
    /// The rows of each cell, one cell after the other.
    pub(super) rows: Vec<Row>,
    /// Rows of a cell.
    pub(super) per_cell: usize,
    /// Of the last pass: the strips of the rows, and K of each node.
    strips: Vec<Strip>,
    controllable: Vec<f64>,
}

/// Rows of a cell for two torques and two accelerations.
const USUAL_ROWS: usize = 4;

impl Cells {
    /// No cells yet, with memory for a number of them.
    pub(super) fn with_capacity(cells: usize) -> Self {
        Self {
            width: Vec::with_capacity(cells),
            ceiling: Vec::with_capacity(cells + 1),
            rows: Vec::with_capacity(USUAL_ROWS * cells),
            per_cell: 0,
            strips: Vec::with_capacity(USUAL_ROWS * cells),
            controllable: Vec::with_capacity(cells + 1),
        }
    }

    /// Turns x at the nodes into that of the least time, by `passes` at most. The viscous term begins
    /// with x as given.
    pub(super) fn solve(&mut self, x: &mut [f64], passes: usize) {
        let viscous = self.rows.iter().any(|row| row.d != 0.0);
        let mut last = self.time(x);
        for _ in 0..passes {
            self.backward(x);
            let time = self.forward(x);
            if !viscous || (time - last).abs() <= CHANGE * time || time.is_infinite() {
                break;
            }
            last = time;
        }
    }

    /// Σ 2w/(√x + √x⁺).
    fn time(&self, x: &[f64]) -> f64 {
        let cells = self.width.iter().zip(x.windows(2));
        cells
            .map(|(w, ends)| 2.0 * w / (ends[0].sqrt() + ends[1].sqrt()))
            .sum()
    }

    /// The strips about x, and K of each node.
    fn backward(&mut self, x: &[f64]) {
        let per_cell = self.per_cell;
        self.strips.resize(self.rows.len(), Strip::default());
        self.controllable.clone_from(&self.ceiling);
        for i in (0..self.width.len()).rev() {
            let (w, root) = (self.width[i], (0.5 * (x[i] + x[i + 1])).sqrt());
            let per_root = 1.0 / root;
            let rows = &self.rows[i * per_cell..(i + 1) * per_cell];
            let strips = &mut self.strips[i * per_cell..(i + 1) * per_cell];
            let beta = 0.5 / w;
            let next = Strip {
                beta,
                lo: 0.0,
                hi: beta * self.controllable[i + 1],
            };
            let mut most = self.controllable[i];
            for k in 0..per_cell {
                let one = rows[k].strip(w, [root, per_root]);
                most = one.with(&next, most);
                for other in &strips[..k] {
                    most = one.with(other, most);
                }
                strips[k] = one;
            }
            self.controllable[i] = most.max(0.0);
        }
    }

    /// The greatest x from rest, and its time.
    fn forward(&self, x: &mut [f64]) -> f64 {
        x[0] = 0.0;
        let (mut rate, mut time) = (0.0, 0.0);
        let cells = self
            .width
            .iter()
            .zip(self.strips.chunks_exact(self.per_cell));
        for (i, (&w, strips)) in cells.enumerate() {
            let most = self.controllable[i + 1];
            let to_next = 0.5 * (most - x[i]) / w;
            let u = strips
                .iter()
                .fold(to_next, |u, strip| u.min(strip.hi - strip.beta * x[i]));
            x[i + 1] = (x[i] + 2.0 * w * u).clamp(0.0, most);
            let next = x[i + 1].sqrt();
            time += 2.0 * w / (rate + next);
            rate = next;
        }
        time
    }
}
