//! TOPP-RA (Pham & Pham 2018) in closed form: the greatest x = ṡ² that can still stop, backward,
//! and the greatest acceleration from rest, forward.
//!
//! On a cell of width w, u is constant and x⁺ = x + 2 w u. A row holds at the cell's middle,
//! where x is x + w u: with p = a + b w and the viscous term about x̂ of the last pass,
//! √x ≈ ½√x̂ + x/(2√x̂),
//!
//! −limit ≤ p u + r x + c ≤ limit  ⇔  lo ≤ u + β x ≤ hi, β = r/p: a strip.
//!
//! Two strips k, l leave a u between them if (βk − βl) x ≤ hik − lol. The neighbour's bound
//! 0 ≤ x⁺ ≤ K⁺ is a strip, too: β = 1/(2w), lo = 0, hi = K⁺/(2w).

use super::limits::Row;

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

/// lo ≤ u + β x ≤ hi.
#[derive(Clone, Copy, Debug, Default)]
struct Strip {
    beta: f64,
    lo: f64,
    hi: f64,
}

/// The relative change of the time from one pass to the next at which the passes end.
const CHANGE: f64 = 1e-7;
/// The most passes; five are usual.
pub(super) const MOST_PASSES: usize = 40;
/// Rows of a cell for two torques and two accelerations.
const USUAL_ROWS: usize = 4;
/// The largest share of what is left of a row's limit that the viscous term's constant part takes,
/// so that the arm can always be at rest.
const VISCOUS_SHARE: f64 = 1.9;

impl Cells {
    /// None yet, with room for a number of cells.
    pub(super) fn with_room(cells: usize) -> Self {
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

/// The greatest x at a place at which some s̈ satisfies all rows: the square of the maximum
/// velocity curve. `ceiling` bounds it from the speeds.
pub(super) fn greatest_x(rows: &[Row], ceiling: f64) -> f64 {
    let (mut x, mut last) = (ceiling, f64::INFINITY);
    for pass in 0..MOST_PASSES {
        let root = if pass == 0 { 0.0 } else { x.sqrt() };
        let about = [root, 1.0 / root];
        let strips: Vec<Strip> = rows.iter().map(|row| row.strip(0.0, about)).collect();
        x = ceiling;
        for (k, one) in strips.iter().enumerate() {
            for other in &strips[k + 1..] {
                x = one.with(other, x);
            }
        }
        x = x.max(0.0);
        if (x - last).abs() <= CHANGE * x {
            break;
        }
        last = x;
    }
    x
}

impl Row {
    /// The strip about √x̂, which is given with its reciprocal.
    fn strip(&self, w: f64, [mut root, mut per_root]: [f64; 2]) -> Strip {
        let (mut r, mut c) = (self.b, self.c);
        if self.d != 0.0 && root > 0.0 {
            let standing = VISCOUS_SHARE * (self.limit - self.c.abs());
            if root * self.d.abs() > standing {
                root = (standing / self.d.abs()).max(f64::MIN_POSITIVE);
                per_root = 1.0 / root;
            }
            r += 0.5 * self.d * per_root;
            c += 0.5 * self.d * root;
        }
        // Without inertia a row bounds x alone: a tiny p does the same.
        let p = self.a + r * w;
        let least = 1e-12 * (self.a.abs() + (r * w).abs()) + f64::MIN_POSITIVE;
        let p = if p.abs() < least { least } else { p };
        let per_p = 1.0 / p;
        let (one, other) = ((-self.limit - c) * per_p, (self.limit - c) * per_p);
        Strip {
            beta: r * per_p,
            lo: one.min(other),
            hi: one.max(other),
        }
    }
}

impl Strip {
    /// The greatest x, `most` at most, at which this strip and another have a common u.
    fn with(&self, other: &Self, most: f64) -> f64 {
        let slope = self.beta - other.beta;
        let room = if slope > 0.0 {
            self.hi - other.lo
        } else {
            other.hi - self.lo
        };
        let slope = slope.abs();
        if room < slope * most {
            room / slope
        } else {
            most
        }
    }
}
