//! Finite mobility: the freedoms that remain after a finite displacement.
//!
//! The null space of the loop Jacobian describes the motion only to first order. So the
//! mechanism is displaced by a finite amount: along a random direction of its null space, each
//! step corrected to closure by Newton's method, until a joint has moved by half a radian (or
//! half the mechanism's size). There the rank is computed again (Huang's third step).
//!
//! This alone does not distinguish a shaky structure from a mechanism, because the correction
//! returns a structure to its start. Therefore a small finite step is tried in each direction
//! at the far end, and the result is the dimension of the displacements that these steps
//! achieve.

use super::loops::Loops;
use super::system::{least_norm, null_space, rank};
use nalgebra::{DMatrix, DVector};
use oorandom::Rand64;

/// The displacement of some joint after which the rank is computed again [rad or sizes].
const TRAVEL: f64 = 0.5;
/// One step along the null space [rad or sizes].
const STEP: f64 = 0.05;
/// The greatest number of steps of a motion.
const MAX_STEPS: usize = 60;
/// The length of the small steps at the far end; their curvature is this share of it.
const PROBE: f64 = 1e-3;
/// A direction counts if the step achieves at least this share of its length.
const ACHIEVED: f64 = 0.05;
/// The closure error at which Newton's method ends.
const CLOSURE_TOLERANCE: f64 = 1e-12;
/// The correction of a shaky structure halves its error in each iteration, or is slower.
const MAX_CORRECTIONS: usize = 120;
/// The number of random motions; a singular pose may lie on several branches.
const TRIALS: u128 = 6;

/// The dimension of the finite motion through the home position: 0 for a structure.
pub(super) fn finite_mobility(loops: &Loops) -> usize {
    let home = DVector::zeros(loops.variables());
    let freedoms = null_space(&loops.jacobian(&home));
    if freedoms.ncols() == 0 || loops.count() == 0 {
        return freedoms.ncols();
    }
    let dimension = |seed| {
        let far = travel(loops, &freedoms, &mut Rand64::new(seed))?;
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
        // The correction has undone most of the step: the branch ends here, or there is no motion.
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

/// The dimension of the displacements that small steps from `q` achieve.
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
    // If the steps achieve orthonormal directions, the singular values are near 1.
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
        // Near a singular pose a full step can be far too long; only its direction is used.
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
