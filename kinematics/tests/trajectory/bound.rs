//! The least time in which a path can be passed within limits of speed and acceleration, by a
//! backward and a forward pass over x = ṡ² (time-optimal path parameterisation).

use fivebar_kinematics::trajectory::{Curve, TrajectorySegment};
use nalgebra::Vector2;

/// A cell of the path: r′ and r″ in its middle, and its length [m].
struct Cell {
    tangent: Vector2<f64>,
    curvature: Vector2<f64>,
    length: f64,
}

impl Cell {
    /// The least and the greatest s̈ at x, if there is any: |r″x + r′s̈| ≤ a.
    fn range(&self, x: f64, speed: f64, a: f64) -> Option<[f64; 2]> {
        let square = self.tangent.norm_squared();
        let lean = self.tangent.dot(&self.curvature) * x;
        let rest = lean * lean - square * (self.curvature.norm_squared() * x * x - a * a);
        let allowed = rest >= 0.0 && x * square <= speed * speed * (1.0 + 1e-9);
        allowed.then(|| [-lean - rest.sqrt(), -lean + rest.sqrt()].map(|v| v / square))
    }
}

/// The greatest value in 0 … `most` that is `fit`, by bisection.
fn greatest(most: f64, fit: impl Fn(f64) -> bool) -> f64 {
    if fit(most) {
        return most;
    }
    let (mut low, mut high) = (0.0, most);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if fit(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The least time [s] along the curves of a trajectory that starts and ends at rest and does not
/// stop in between.
pub(crate) fn least_time(trajectory: &[TrajectorySegment<f64>], speed: f64, a: f64) -> f64 {
    let mut cells = Vec::new();
    for piece in trajectory.chunk_by(|one, other| one.curve() == other.curve()) {
        let (first, last) = (&piece[0], &piece[piece.len() - 1]);
        let curve = first.curve().expect("a path");
        let [from, to] = [first.path_state(0.0), last.path_state(last.duration())].map(|at| at.s);
        let count = match curve {
            Curve::Line { .. } => ((to - from) / 1e-4).ceil().max(4.0) as u32,
            _ => 24,
        };
        let length = (to - from) / f64::from(count);
        cells.extend((0..count).map(|cell| {
            let at = curve.at(from + length * (f64::from(cell) + 0.5));
            Cell {
                tangent: at.tangent,
                curvature: at.curvature,
                length,
            }
        }));
    }
    // The greatest x at the start of each cell from which the rest of the path can be passed.
    let mut ceiling = vec![0.0; cells.len() + 1];
    for (index, cell) in cells.iter().enumerate().rev() {
        let after: f64 = ceiling[index + 1];
        let most = speed * speed / cell.tangent.norm_squared();
        ceiling[index] = greatest(most, |x| {
            let next = after.min(x);
            let range = cell.range(0.5 * (x + next), speed, a);
            range.is_some_and(|[least, _]| (next - x) / (2.0 * cell.length) >= least)
        });
    }
    let (mut x, mut time) = (0.0_f64, 0.0);
    for (cell, &after) in cells.iter().zip(&ceiling[1..]) {
        let next = greatest(after, |next| {
            let range = cell.range(0.5 * (x + next), speed, a);
            range.is_some_and(|[_, most]| (next - x) / (2.0 * cell.length) <= most)
        });
        time += 2.0 * cell.length / (x.sqrt() + next.sqrt());
        x = next;
    }
    time
}
