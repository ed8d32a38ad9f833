//! A law s(t) as a uniform cubic B-spline: the smooth form of a run that a tick can follow.
//!
//! Its control points are s of the run at even times, those of the ends threefold. So it stays on the path,
//! never goes back, begins and ends at rest with no acceleration, and its acceleration is continuous:
//! between two knots s(t) is a cubic. It averages s(t) over four intervals and takes two intervals
//! longer.

/// The law, one cubic between two knots.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spline {
    points: Vec<f64>,
    /// Time between two knots [s].
    pub(super) interval: f64,
}

/// s, ṡ, s̈ and s⃛ at one time.
pub(super) type State = [f64; 4];

impl Spline {
    /// The spline of s at even times `interval` [s] apart, first and last included.
    pub(super) fn new(samples: &[f64], interval: f64) -> Self {
        let (first, last) = (samples[0], samples[samples.len() - 1]);
        let mut points = vec![first; 2];
        points.extend_from_slice(samples);
        points.extend([last; 2]);
        Self { points, interval }
    }

    /// The number of intervals.
    pub(super) fn len(&self) -> usize {
        self.points.len() - 3
    }

    /// Its duration [s].
    pub(super) fn duration(&self) -> f64 {
        self.interval * self.len() as f64
    }

    /// s, ṡ, s̈ at the beginning of an interval, and s⃛ in it.
    pub(super) fn start(&self, interval: usize) -> State {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.points[interval + k]);
        let h = self.interval;
        [
            (a + 4.0 * b + c) / 6.0,
            (c - a) / (2.0 * h),
            (a - 2.0 * b + c) / (h * h),
            (d - 3.0 * c + 3.0 * b - a) / (h * h * h),
        ]
    }

    /// The same motion slower by κ.
    pub(super) fn slowed(mut self, kappa: f64) -> Self {
        self.interval *= kappa;
        self
    }
}

/// A state `t` [s] later.
pub(super) fn later([s, v, a, j]: State, t: f64) -> State {
    [
        s + t * (v + t * (a / 2.0 + t * j / 6.0)),
        v + t * (a + t * j / 2.0),
        a + t * j,
        j,
    ]
}

/// Most steps to a position. Halving alone brings the bounds together to 2⁻⁶⁰ of the whole time, below
/// the rounding of an f64.
const STEPS: usize = 60;
/// The step in time, as a share of the whole, at which the search ends: a few roundings of an f64.
const CLOSE: f64 = 1e-15;

/// The time within 0…`most` [s] at which s of a state becomes `target`, by Newton's method within
/// bounds: s rises.
pub(super) fn time_at(state: State, target: f64, most: f64) -> f64 {
    let (mut low, mut high) = (0.0, most);
    let mut t = 0.5 * most;
    for _ in 0..STEPS {
        let [s, v, ..] = later(state, t);
        if s < target {
            low = t;
        } else {
            high = t;
        }
        let newton = t - (s - target) / v;
        let next = if low <= newton && newton <= high {
            newton
        } else {
            0.5 * (low + high)
        };
        let step = (next - t).abs();
        t = next;
        if step <= CLOSE * most {
            break;
        }
    }
    t
}
