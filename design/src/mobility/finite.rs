//! Finite mobility: what is left of the instantaneous freedoms after a real motion.
//!
//! The null space of the loop Jacobian is only the first order. A mechanism is moved for
//! real: along a random direction of its null space, each step corrected onto the closure
//! by Newton's method, until a joint has gone half a radian (or half the mechanism's
//! size). There the rank is taken again (Huang's third step).
//!
//! That alone does not tell a shaky structure from a mechanism, since a structure's
//! correction runs back to where it started. So at the far end each direction is tried by
//! a small real step, and only the dimension of what those steps achieve counts.

use super::loops::Loops;
use super::system::{least_norm, null_space, rank};
use nalgebra::{DMatrix, DVector};
use oorandom::Rand64;

/// How far some joint must go before the rank is believed [rad or sizes].
const TRAVEL: f64 = 0.5;
/// One step along the null space [rad or sizes].
const STEP: f64 = 0.05;
/// Steps after which a motion that gets nowhere is given up.
const MAX_STEPS: usize = 60;
/// The small real steps at the far end: their curvature is this share of their length.
const PROBE: f64 = 1e-3;
/// A probe's direction counts when achieved to this share of what was asked.
const ACHIEVED: f64 = 0.05;
/// Closure to which Newton's method corrects.
const CLOSURE_TOLERANCE: f64 = 1e-12;
/// Corrections to a structure that snaps back converge by halves or slower.
const MAX_CORRECTIONS: usize = 120;
/// Random motions tried; a singular pose may lie on several branches.
const TRIALS: u128 = 6;

/// The dimension of the finite motion through the home position: 0 for a structure.
pub(super) fn finite_mobility(loops: &Loops) -> usize {
    let home = DVector::zeros(loops.variables());
    let freedoms = null_space(&loops.jacobian(&home));
    if freedoms.ncols() == 0 || loops.count() == 0 {
        return freedoms.ncols();
    }
    let dimension = |trial| {
        let far = travel(loops, &freedoms, &mut Rand64::new(trial))?;
        Some(local_dimension(loops, &far))
    };
    (1..=TRIALS).filter_map(dimension).max().unwrap_or(0)
}

/// A configuration [`TRAVEL`] away from home, reached through closed configurations.
fn travel(loops: &Loops, freedoms: &DMatrix<f64>, random: &mut Rand64) -> Option<DVector<f64>> {
    let mut q = DVector::zeros(loops.variables());
    let mut direction = unit(freedoms * somewhere(freedoms.ncols(), random))?;
    for _ in 0..MAX_STEPS {
        let next = correct(loops, &q + &direction * STEP)?;
        let moved = &next - &q;
        // A step that is mostly undone has run into the end of a branch, or was none.
        if moved.amax() < 0.1 * STEP {
            return None;
        }
        q = next;
        if q.amax() >= TRAVEL {
            return Some(q);
        }
        let tangent = null_space(&loops.jacobian(&q));
        direction = unit(&tangent * (tangent.transpose() * moved))?;
    }
    None
}

/// The dimension of the motions that small real steps from `q` achieve.
fn local_dimension(loops: &Loops, q: &DVector<f64>) -> usize {
    let tangent = null_space(&loops.jacobian(q));
    let achieved: Vec<DVector<f64>> = tangent
        .column_iter()
        .filter_map(|direction| correct(loops, q + direction * PROBE))
        .map(|reached| (reached - q) / PROBE)
        .collect();
    if achieved.is_empty() {
        return 0;
    }
    // Orthonormal directions, if achieved, stay nearly so: singular values near 1.
    let singular = DMatrix::from_columns(&achieved).singular_values();
    singular.iter().filter(|&&value| value > ACHIEVED).count()
}

/// The closed configuration that Newton's method with least-norm steps reaches from `q`.
fn correct(loops: &Loops, mut q: DVector<f64>) -> Option<DVector<f64>> {
    for _ in 0..MAX_CORRECTIONS {
        let residual = loops.residual(&q);
        if residual.amax() < CLOSURE_TOLERANCE {
            return Some(q);
        }
        let step = least_norm(&loops.jacobian(&q), &residual)?;
        // Near a singular pose a full step can be absurd; its direction still serves.
        let shorten = (2.0 * STEP / step.amax().max(f64::MIN_POSITIVE)).min(1.0);
        q -= step * shorten;
    }
    None
}

fn unit(vector: DVector<f64>) -> Option<DVector<f64>> {
    let largest = vector.amax();
    (largest > 0.0).then(|| vector / largest)
}

/// N − rank J at home.
pub(super) fn instantaneous_mobility(loops: &Loops) -> usize {
    let home = DVector::zeros(loops.variables());
    loops.variables() - rank(&loops.jacobian(&home))
}

/// A vector of numbers uniform in −1…1.
fn somewhere(length: usize, random: &mut Rand64) -> DVector<f64> {
    DVector::from_fn(length, |_, _| 2.0 * random.rand_float() - 1.0)
}
