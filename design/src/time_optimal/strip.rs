//! One limit at one point as a row, and as a strip in the plane of x = ṡ² and u = s̈.
//!
//! A row holds at the middle of a cell of width w, where x is x + w u: with p = a + b w and the
//! viscous term about x̂ of the last pass, √x ≈ ½√x̂ + x/(2√x̂),
//!
//! −limit ≤ p u + r x + c ≤ limit  ⇔  lo ≤ u + β x ≤ hi, β = r/p: a strip.
//!
//! Two strips k, l leave a u between them if (βk − βl) x ≤ hik − lol.

/// One limit of the acceleration along the path at one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) a: f64,
    pub(super) b: f64,
    pub(super) c: f64,
    pub(super) d: f64,
    pub(super) limit: f64,
}

/// lo ≤ u + β x ≤ hi.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strip {
    pub(super) beta: f64,
    pub(super) lo: f64,
    pub(super) hi: f64,
}

/// The relative change of the time from one pass to the next at which the passes end.
pub(super) const CHANGE: f64 = 1e-7;
/// The most passes; five are usual.
pub(super) const MOST_PASSES: usize = 40;
/// The largest share of what is left of a row's limit that the viscous term's constant part takes,
/// so that the arm can always be at rest.
const VISCOUS_SHARE: f64 = 1.9;

impl Row {
    /// The strip about √x̂, which is given with its reciprocal.
    pub(super) fn strip(&self, w: f64, [mut root, mut per_root]: [f64; 2]) -> Strip {
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
    pub(super) fn with(&self, other: &Self, most: f64) -> f64 {
        let slope = self.beta - other.beta;
        let gap = if slope > 0.0 {
            self.hi - other.lo
        } else {
            other.hi - self.lo
        };
        let slope = slope.abs();
        if gap < slope * most {
            gap / slope
        } else {
            most
        }
    }
}

/// The greatest x at a point at which some s̈ satisfies all rows: the square of the maximum
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
