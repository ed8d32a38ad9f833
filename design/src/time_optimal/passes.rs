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
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// w of each cell.
    pub(super) width: Vec<f64>,
    /// The greatest x at each node.
    pub(super) ceiling: Vec<f64>,
    /// The rows of each cell, one cell after the other.
    pub(super) rows: Vec<Row>,
    /// Rows of a cell.
    pub(super) per_cell: usize,
}

/// lo ≤ u + β x ≤ hi.
#[derive(Clone, Copy)]
struct Strip {
    beta: f64,
    lo: f64,
    hi: f64,
}

/// The relative change of the time from one pass to the next at which the passes end.
const CHANGE: f64 = 1e-7;
/// The most passes; five are usual.
pub(super) const MOST_PASSES: usize = 40;
/// The largest share of what is left of a row's limit that the viscous term's constant part takes,
/// so that the arm can always be at rest.
const VISCOUS_SHARE: f64 = 1.9;

impl Cells {
    /// x at the nodes for the least time, starting the viscous term at `guess` if there is one,
    /// by `passes` at most.
    pub(super) fn solve(&self, guess: Option<&[f64]>, passes: usize) -> Vec<f64> {
        let mut strips = Vec::with_capacity(self.rows.len());
        let mut x = guess.map_or_else(|| vec![0.0; self.ceiling.len()], <[f64]>::to_vec);
        let viscous = self.rows.iter().any(|row| row.d != 0.0);
        let mut last = f64::INFINITY;
        for _ in 0..passes {
            self.strips(&x, &mut strips);
            let controllable = self.backward(&strips);
            self.forward(&strips, &controllable, &mut x);
            let time = self.time(&x);
            if !viscous || (time - last).abs() <= CHANGE * time || time.is_infinite() {
                break;
            }
            last = time;
        }
        x
    }

    /// Σ 2w/(√x + √x⁺).
    pub(super) fn time(&self, x: &[f64]) -> f64 {
        let cells = self.width.iter().zip(x.windows(2));
        cells
            .map(|(w, ends)| 2.0 * w / (ends[0].sqrt() + ends[1].sqrt()))
            .sum()
    }

    fn strips(&self, x: &[f64], strips: &mut Vec<Strip>) {
        strips.clear();
        let cells = self.width.iter().zip(x.windows(2));
        for ((&w, ends), rows) in cells.zip(self.rows.chunks_exact(self.per_cell)) {
            let root = (0.5 * (ends[0] + ends[1])).sqrt();
            strips.extend(rows.iter().map(|row| row.strip(w, root)));
        }
    }

    fn backward(&self, strips: &[Strip]) -> Vec<f64> {
        let mut controllable = self.ceiling.clone();
        for i in (0..self.width.len()).rev() {
            let w = self.width[i];
            let own = &strips[i * self.per_cell..(i + 1) * self.per_cell];
            let beta = 0.5 / w;
            let next = Strip {
                beta,
                lo: 0.0,
                hi: beta * controllable[i + 1],
            };
            let mut most = controllable[i];
            for (k, one) in own.iter().enumerate() {
                most = one.with(&next, most);
                for other in &own[k + 1..] {
                    most = one.with(other, most);
                }
            }
            controllable[i] = most.max(0.0);
        }
        controllable
    }

    fn forward(&self, strips: &[Strip], controllable: &[f64], x: &mut [f64]) {
        x[0] = 0.0;
        for i in 0..self.width.len() {
            let w = self.width[i];
            let own = &strips[i * self.per_cell..(i + 1) * self.per_cell];
            let to_next = 0.5 * (controllable[i + 1] - x[i]) / w;
            let u = own
                .iter()
                .fold(to_next, |u, strip| u.min(strip.hi - strip.beta * x[i]));
            x[i + 1] = (x[i] + 2.0 * w * u).clamp(0.0, controllable[i + 1]);
        }
    }
}

/// The greatest x at a place at which some s̈ satisfies all rows: the square of the maximum
/// velocity curve. `ceiling` bounds it from the speeds.
pub(super) fn greatest_x(rows: &[Row], ceiling: f64) -> f64 {
    let (mut x, mut last) = (ceiling, f64::INFINITY);
    for pass in 0..MOST_PASSES {
        let root = if pass == 0 { 0.0 } else { x.sqrt() };
        let strips: Vec<Strip> = rows.iter().map(|row| row.strip(0.0, root)).collect();
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
    /// The strip about √x̂.
    fn strip(&self, w: f64, root: f64) -> Strip {
        let (mut r, mut c) = (self.b, self.c);
        if self.d != 0.0 && root > 0.0 {
            let standing = VISCOUS_SHARE * (self.limit - self.c.abs());
            let root = if root * self.d.abs() > standing {
                (standing / self.d.abs()).max(f64::MIN_POSITIVE)
            } else {
                root
            };
            r += 0.5 * self.d / root;
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
